//! `explore --profile FILE`: cycles of the emulated chip by function.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use host_sim::link::cycles::{PLUGIN_VARIABLE, plugin};
use host_sim::link::image::image;
use host_sim::link::profile::RawProfile;
use host_sim::link::spec::LinkSpec;

use super::note;

/// The file that a run's profile goes into, and what the plugin counts meanwhile.
pub(super) struct Profiler {
    path: PathBuf,
    file: File,
    raw: RawProfile,
}

impl Profiler {
    /// Begins the file. One that is there is replaced only if `may_replace`.
    pub(super) fn open(path: &Path, link: &LinkSpec, may_replace: bool) -> Result<Self> {
        let name = path.display();
        if *link != LinkSpec::Qemu {
            bail!("--profile {name}: only the emulated chip counts cycles; say --link qemu");
        }
        if path.exists() && !may_replace {
            bail!(
                "--profile {name}: the file is there; say --force to replace it, or name another \
                 one"
            );
        }
        match plugin() {
            Ok(Some(_)) => {}
            Ok(None) => bail!(
                "--profile {name}: {PLUGIN_VARIABLE}=off leaves out the plugin that counts cycles; \
                 unset it"
            ),
            Err(error) => bail!(
                "--profile {name}: no plugin counts cycles: {error}; mend that, or leave --profile \
                 out"
            ),
        }
        let file = File::create(path);
        Ok(Self {
            file: file.with_context(|| format!("--profile {name}: it cannot be written"))?,
            path: path.into(),
            raw: RawProfile::new(),
        })
    }

    /// Returns where the plugin counts.
    pub(super) fn raw(&self) -> &Path {
        self.raw.path()
    }

    /// Writes what was counted, and says so.
    pub(super) fn end(self, world: &str) {
        let name = self.path.display();
        let written = image().and_then(|image| self.raw.folded(&image));
        let written = written.map_err(anyhow::Error::from).and_then(|folded| {
            folded.write(BufWriter::new(&self.file))?;
            Ok(folded.cycles())
        });
        note(&match written {
            Ok(cycles) => {
                let millions = cycles as f64 / 1e6;
                format!("{world}: {millions:.2} M cycles by function in {name}")
            }
            Err(error) => format!("host-sim: --profile {name}: {error}; the file is not whole"),
        });
    }
}
