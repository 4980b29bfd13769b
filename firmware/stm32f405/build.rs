//! Linker arguments of the image. They are here and not in RUSTFLAGS, so that no environment can
//! lose them.

use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return Ok(());
    }
    let out = PathBuf::from(env::var("OUT_DIR").map_err(io::Error::other)?);
    fs::copy("memory.x", out.join("memory.x"))?;
    println!("cargo::rustc-link-search={}", out.display());
    for kind in ["bins", "examples"] {
        println!("cargo::rustc-link-arg-{kind}=--nmagic");
        println!("cargo::rustc-link-arg-{kind}=-Tlink.x");
    }
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    Ok(())
}
