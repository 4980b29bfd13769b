//! The device's log as text: defmt bytes, decoded with the tables in the image's ELF file.

use std::path::Path;

use defmt_decoder::{DecodeError, Locations, StreamDecoder, Table};

use super::LinkError;

/// The tables of one image, and the bytes of an incomplete message.
pub struct Decoder {
    table: Table,
    places: Locations,
    rest: Vec<u8>,
}

impl core::fmt::Debug for Decoder {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Decoder")
            .field("rest", &self.rest)
            .finish_non_exhaustive()
    }
}

impl Decoder {
    /// The decoder of an image. It must be the image that runs on the device.
    ///
    /// # Errors
    /// [`LinkError::Io`] if the file cannot be read or is not an image with a log.
    pub fn of(image: &Path) -> Result<Self, LinkError> {
        let name = image.display();
        let io =
            |what: String| LinkError::Io(format!("cannot read the log's tables of {name}: {what}"));
        let elf = std::fs::read(image).map_err(|error| io(error.to_string()))?;
        let table = Table::parse(&elf)
            .map_err(|error| io(error.to_string()))?
            .ok_or_else(|| io("it has none; give the image's ELF file".into()))?;
        let places = table
            .get_locations(&elf)
            .map_err(|error| io(error.to_string()))?;
        Ok(Self {
            table,
            places,
            rest: Vec::new(),
        })
    }

    /// Returns the messages that `bytes` complete, one line each: level, text, place.
    pub fn lines(&mut self, bytes: &[u8]) -> Vec<String> {
        self.rest.extend_from_slice(bytes);
        // Messages end with a zero; a broken message is skipped up to it.
        let whole = self
            .rest
            .iter()
            .rposition(|byte| *byte == 0)
            .map_or(0, |at| at + 1);
        let mut decoder = self.table.new_stream_decoder();
        decoder.received(&self.rest[..whole]);
        let lines = self.read(decoder.as_mut());
        drop(decoder);
        self.rest.drain(..whole);
        lines
    }

    fn read(&self, decoder: &mut (dyn StreamDecoder + '_)) -> Vec<String> {
        let mut lines = Vec::new();
        loop {
            match decoder.decode() {
                Ok(message) => {
                    let level = message.level().map_or("print", |level| level.as_str());
                    let place = self.place(message.index());
                    let text = message.display_message();
                    lines.push(format!("{} {text}{place}", level.to_uppercase()));
                }
                Err(DecodeError::UnexpectedEof) => return lines,
                Err(DecodeError::Malformed) => lines.push("(a log message was lost)".into()),
            }
        }
    }

    /// File, relative to the source tree's root, and line of a message.
    fn place(&self, message: u64) -> String {
        let Some(place) = self.places.get(&message) else {
            return String::new();
        };
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
        let file = root.and_then(|root| place.file.strip_prefix(root).ok());
        format!(
            " ({}:{})",
            file.unwrap_or(&place.file).display(),
            place.line
        )
    }
}
