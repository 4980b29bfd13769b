//! The firmware image: the file that the environment names, or else built from the source tree.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::LinkError;
use super::cargo::{self, NotBuilt};

/// Environment variable with the path of an image to use instead of a new build.
pub const IMAGE_VARIABLE: &str = "FIELDLINE_IMAGE";

const TARGET: &str = "thumbv7em-none-eabihf";
const PACKAGE: &str = "fieldline-stm32f405";

/// The image's ELF file: the one in [`IMAGE_VARIABLE`], or else built once per process. The build
/// is quick if the image is up to date.
///
/// # Errors
/// [`LinkError::Io`] naming what is missing and what to type.
pub fn image() -> Result<PathBuf, LinkError> {
    static IMAGE: OnceLock<Result<PathBuf, LinkError>> = OnceLock::new();
    match std::env::var_os(IMAGE_VARIABLE) {
        Some(path) => existing(PathBuf::from(path)),
        None => IMAGE.get_or_init(|| build(&[])).clone(),
    }
}

fn existing(path: PathBuf) -> Result<PathBuf, LinkError> {
    if path.is_file() {
        return Ok(path);
    }
    Err(LinkError::Io(format!(
        "there is no image at {}; set {IMAGE_VARIABLE} to one, or unset it to build one",
        path.display()
    )))
}

/// Builds the image with more arguments for cargo and returns its path.
///
/// # Errors
/// [`LinkError::Io`] naming what is missing and what to type.
pub fn build(arguments: &[&str]) -> Result<PathBuf, LinkError> {
    let mut all = vec!["--profile", "firmware", "--target", TARGET];
    all.extend(arguments);
    let messages = cargo::build("firmware/stm32f405", PACKAGE, &all).map_err(|error| {
        LinkError::Io(match error {
            NotBuilt::NoSources(root) => format!(
                "there is no source tree at {} to build the image from; \
                 set {IMAGE_VARIABLE} to an ELF file",
                root.display()
            ),
            NotBuilt::NoCargo(error) => format!(
                "cannot run cargo to build the image: {error}; \
                 install Rust, or set {IMAGE_VARIABLE} to an ELF file"
            ),
            NotBuilt::Failed(log) => explain(&log),
        })
    })?;
    executable(&messages).ok_or_else(|| {
        LinkError::Io("cargo built the image and did not say where; run `cargo image`".into())
    })
}

fn explain(log: &str) -> String {
    if log.contains("can't find crate for `core`") || log.contains("may not be installed") {
        return format!("the image's target is not installed; type: rustup target add {TARGET}");
    }
    let first = cargo::first_error(log);
    format!("building the image failed: {first}; type `cargo image` to see all of it")
}

/// The last path in cargo's messages `{"reason":"compiler-artifact",…,"executable":"…"}`.
fn executable(messages: &str) -> Option<PathBuf> {
    const KEY: &str = "\"executable\":\"";
    let line = messages.lines().rfind(|line| line.contains(KEY))?;
    let rest = &line[line.find(KEY)? + KEY.len()..];
    let path = &rest[..rest.find('"')?];
    Some(PathBuf::from(
        path.replace("\\\\", "\\").replace("\\/", "/"),
    ))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::{executable, existing, explain};

    #[test]
    fn the_last_executable_in_cargos_messages_is_the_image() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","target":{},"executable":null,"fresh":true}"#,
            "\n",
            r#"{"reason":"compiler-artifact","executable":"/t/fieldline-stm32f405","fresh":true}"#,
            "\n",
            r#"{"reason":"build-finished","success":true}"#,
        );
        assert_eq!(
            executable(messages),
            Some(PathBuf::from("/t/fieldline-stm32f405"))
        );
        assert_eq!(executable("{}"), None);
    }

    #[test]
    fn a_missing_target_is_named_with_the_command_to_type() {
        let missing = concat!(
            "error[E0463]: can't find crate for `core`\n",
            "  = note: the `thumbv7em-none-eabihf` target may not be installed",
        );
        assert!(explain(missing).contains("rustup target add thumbv7em-none-eabihf"));
        let broken = "warning: x\nerror[E0308]: mismatched types\n --> a.rs";
        assert!(explain(broken).contains("error[E0308]: mismatched types"));
        let error = existing(PathBuf::from("/no/image")).unwrap_err();
        assert!(error.to_string().contains("/no/image"), "{error}");
    }
}
