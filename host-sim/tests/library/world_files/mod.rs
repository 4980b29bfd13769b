//! Files of worlds and of known maps: what is read from them, and the error line for each fault.

mod heights;
mod known_maps;
mod maps;

use std::fs;
use std::path::{Path, PathBuf};

use host_sim::world::World;

/// A temporary folder of one test; dropping this value removes it.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("fieldline-{}-{test}", std::process::id()));
        fs::create_dir_all(&path).expect("temporary folder");
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, bytes).expect("temporary file");
        path
    }

    /// The error line for a world file with this text, without the folder.
    fn error(&self, text: &str) -> String {
        let path = self.write("world.yaml", text);
        let error = World::load(&path).expect_err("must not load").to_string();
        assert!(!error.contains('\n'), "one line: {error}");
        error.replace(&format!("{}/", self.0.display()), "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn png(path: &Path, size: (u32, u32), kind: (png::ColorType, png::BitDepth), data: &[u8]) {
    let file = fs::File::create(path).expect("temporary file");
    let mut encoder = png::Encoder::new(file, size.0, size.1);
    encoder.set_color(kind.0);
    encoder.set_depth(kind.1);
    if kind.0 == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 255, 255, 205, 205, 205]);
    }
    let mut writer = encoder.write_header().expect("header");
    writer.write_image_data(data).expect("data");
}

/// The required keys of a world file.
const KEYS: &str = "resolution: 1.0\norigin: [-1, 2, 0]\n";
