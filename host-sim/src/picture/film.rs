//! Films of a run: a GIF of our own making, or an MP4 by `ffmpeg` if the machine has it.
//!
//! ```text
//! frame k ─► changed rectangle against frame k − 1 ─► GIF, each with a palette of its own
//!        └─► raw pixels ─► ffmpeg ─► MP4 (H.264, yuv420p: every player shows it)
//! ```
//!
//! All frames have the size of the last one, which shows all: a page that is larger is cut, a
//! smaller one is filled with its corner's colour. The file is made under another name and renamed
//! when it is whole, so a film that is there is never half of one.
//!
//! Units: pixels; hundredths of a second.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use thiserror::Error;

use super::Pixels;

/// Frames of a second.
pub const RATE: u16 = 10;
/// Frames for which the last page stays.
const LAST: u16 = 3 * RATE;
/// Speed of the search for a palette, 1 to 30; a page has few colours.
const PALETTE_SPEED: i32 = 10;

/// Why there is no film.
#[derive(Debug, Error)]
pub enum FilmError {
    /// Its name tells no kind.
    #[error("a film is FILE.gif or FILE.mp4")]
    Kind,
    /// An MP4 needs a program.
    #[error("an MP4 is made by ffmpeg, which is missing: install it, or name FILE.gif ({0})")]
    NoFfmpeg(std::io::Error),
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] std::io::Error),
    /// The encoder of GIFs failed.
    #[error(transparent)]
    Gif(#[from] gif::EncodingError),
    /// `ffmpeg` failed; its last words.
    #[error("ffmpeg failed: {0}")]
    Ffmpeg(String),
}

/// The kind of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Gif,
    Mp4,
}

/// A film to be made.
#[derive(Clone, Debug)]
pub struct Film {
    file: PathBuf,
    kind: Kind,
}

impl Film {
    /// Checks that a film of this name can be made: its kind, and the program that an MP4 needs.
    ///
    /// # Errors
    /// [`FilmError::Kind`], [`FilmError::NoFfmpeg`].
    pub fn new(file: &Path) -> Result<Self, FilmError> {
        let kind = match file.extension().and_then(|it| it.to_str()) {
            Some("gif") => Kind::Gif,
            Some("mp4") => Kind::Mp4,
            _ => return Err(FilmError::Kind),
        };
        if kind == Kind::Mp4 {
            let mut asked = Command::new("ffmpeg");
            asked.arg("-version").stdout(Stdio::null());
            asked.status().map_err(FilmError::NoFfmpeg)?;
        }
        Ok(Self {
            file: file.into(),
            kind,
        })
    }

    /// Makes the film of these frames and a last one, which stays for three seconds.
    ///
    /// # Errors
    /// [`FilmError`]; a film that was there is still the older one.
    pub fn make(
        &self,
        frames: impl IntoIterator<Item = Pixels>,
        last: Pixels,
    ) -> Result<(), FilmError> {
        let size = (even(last.width), even(last.height));
        let frames = frames.into_iter().chain([last]);
        let frames = frames.map(|page| fitted(page, size));
        let mut part = self.file.clone().into_os_string();
        part.push(".part");
        let part = PathBuf::from(part);
        let made = match self.kind {
            Kind::Gif => gif(&part, size, frames),
            Kind::Mp4 => mp4(&part, size, frames),
        };
        match made {
            Ok(()) => Ok(std::fs::rename(&part, &self.file)?),
            Err(error) => {
                // It may not be there.
                let _ = std::fs::remove_file(&part);
                Err(error)
            }
        }
    }
}

/// H.264 wants even sides; a GIF's are at most 65,535.
fn even(side: usize) -> usize {
    side.min(65_534) & !1
}

/// Returns a page with this width and height, cut or filled.
fn fitted(page: Pixels, (width, height): (usize, usize)) -> Pixels {
    if (page.width, page.height) == (width, height) {
        return page;
    }
    let corner: Vec<u8> = page.rgba.iter().take(4).copied().collect();
    let mut rgba = corner.repeat(width * height);
    let both = width.min(page.width) * 4;
    let rows = page.rgba.chunks_exact(page.width * 4);
    for (to, from) in rgba.chunks_exact_mut(width * 4).zip(rows) {
        to[..both].copy_from_slice(&from[..both]);
    }
    Pixels {
        width,
        height,
        rgba,
    }
}

/// A rectangle of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rectangle {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// Returns the least rectangle in which two pages of one size differ; one pixel if they are equal.
fn changed(before: &Pixels, now: &Pixels) -> Rectangle {
    let rows = before.rgba.chunks_exact(before.width * 4);
    let rows = rows.zip(now.rgba.chunks_exact(now.width * 4));
    let (mut columns, mut lines) = (None::<(usize, usize)>, None::<(usize, usize)>);
    for (y, (old, new)) in rows.enumerate().filter(|(_, (old, new))| old != new) {
        let differs = |x: &usize| old[4 * x..4 * x + 4] != new[4 * x..4 * x + 4];
        let first = (0..now.width).find(differs).unwrap_or(0);
        let last = (0..now.width).rev().find(differs).unwrap_or(first);
        let (left, right) = columns.unwrap_or((first, last));
        columns = Some((left.min(first), right.max(last)));
        lines = Some((lines.map_or(y, |(top, _)| top), y));
    }
    let (left, right) = columns.unwrap_or((0, 0));
    let (top, bottom) = lines.unwrap_or((0, 0));
    Rectangle {
        left,
        top,
        width: right - left + 1,
        height: bottom - top + 1,
    }
}

/// Returns the pixels of a rectangle.
fn cut(page: &Pixels, part: Rectangle) -> Vec<u8> {
    let rows = page.rgba.chunks_exact(page.width * 4);
    let rows = rows.skip(part.top).take(part.height);
    rows.flat_map(|row| &row[4 * part.left..4 * (part.left + part.width)])
        .copied()
        .collect()
}

/// Writes a GIF that plays without end.
fn gif(
    file: &Path,
    (width, height): (usize, usize),
    frames: impl Iterator<Item = Pixels>,
) -> Result<(), FilmError> {
    let to = BufWriter::new(File::create(file)?);
    let mut encoder = gif::Encoder::new(to, width as u16, height as u16, &[])?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    let mut frames = frames.peekable();
    let mut before: Option<Pixels> = None;
    while let Some(page) = frames.next() {
        let whole = Rectangle {
            left: 0,
            top: 0,
            width,
            height,
        };
        let part = before.as_ref().map_or(whole, |it| changed(it, &page));
        let mut pixels = cut(&page, part);
        let (wide, high) = (part.width as u16, part.height as u16);
        let mut frame = gif::Frame::from_rgba_speed(wide, high, &mut pixels, PALETTE_SPEED);
        (frame.left, frame.top) = (part.left as u16, part.top as u16);
        frame.dispose = gif::DisposalMethod::Keep;
        let shown = if frames.peek().is_some() { 1 } else { LAST };
        frame.delay = 100 / RATE * shown;
        encoder.write_frame(&frame)?;
        before = Some(page);
    }
    encoder.into_inner()?.flush()?;
    Ok(())
}

/// Gives the frames to `ffmpeg`.
fn mp4(
    file: &Path,
    (width, height): (usize, usize),
    frames: impl Iterator<Item = Pixels>,
) -> Result<(), FilmError> {
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg
        .args(["-loglevel", "error", "-y", "-f", "rawvideo"])
        .args(["-pixel_format", "rgba", "-video_size"])
        .arg(format!("{width}x{height}"))
        .args(["-framerate", &RATE.to_string(), "-i", "-"])
        .args(["-pix_fmt", "yuv420p", "-f", "mp4"])
        .arg(file)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut child = ffmpeg.spawn().map_err(FilmError::NoFfmpeg)?;
    // If it stops early, its own words say more than a broken pipe.
    let _ = feed(&mut child, frames);
    let ended = child.wait_with_output()?;
    if ended.status.success() {
        return Ok(());
    }
    let words = String::from_utf8_lossy(&ended.stderr);
    let last = words.lines().last().unwrap_or("it said nothing");
    Err(FilmError::Ffmpeg(last.into()))
}

/// Writes frames to a program, the last one for three seconds, and ends its input.
fn feed(child: &mut Child, frames: impl Iterator<Item = Pixels>) -> std::io::Result<()> {
    let Some(mut input) = child.stdin.take() else {
        return Ok(());
    };
    let mut last = None;
    for page in frames {
        input.write_all(&page.rgba)?;
        last = Some(page);
    }
    for page in last.iter().cycle().take(usize::from(LAST) - 1) {
        input.write_all(&page.rgba)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Film, FilmError, Rectangle, changed, fitted};
    use crate::picture::Pixels;

    /// Draws a page: a digit is a grey.
    fn drawn(rows: &[&str]) -> Pixels {
        let grey = |digit: u8| [25 * (digit - b'0'), 25 * (digit - b'0'), 90, 255];
        Pixels {
            width: rows[0].len(),
            height: rows.len(),
            rgba: rows
                .iter()
                .flat_map(|row| row.bytes().flat_map(grey))
                .collect(),
        }
    }

    #[test]
    fn the_changed_rectangle_holds_all_changes_and_no_more() {
        let before = drawn(&["0000", "0000", "0000", "0000"]);
        let now = drawn(&["0000", "0010", "0000", "0100"]);
        let part = |left, top, width, height| Rectangle {
            left,
            top,
            width,
            height,
        };
        assert_eq!(changed(&before, &now), part(1, 1, 2, 3));
        assert_eq!(changed(&now, &now), part(0, 0, 1, 1));
        let all = drawn(&["1000", "0000", "0000", "0001"]);
        assert_eq!(changed(&before, &all), part(0, 0, 4, 4));
    }

    #[test]
    fn a_page_of_another_size_is_cut_or_filled_with_its_corner() {
        let page = drawn(&["12", "34"]);
        assert_eq!(fitted(page.clone(), (3, 1)), drawn(&["121"]));
        assert_eq!(fitted(page, (1, 3)), drawn(&["1", "3", "1"]));
    }

    /// A reader that draws part after part must see every frame as it was.
    #[test]
    fn a_gif_shows_every_frame_bit_for_bit() {
        let pages = [
            drawn(&["0000", "0000"]),
            drawn(&["0010", "0000"]),
            drawn(&["0010", "0000"]),
            drawn(&["9010", "0007"]),
        ];
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("film.gif");
        let film = Film::new(&file).expect("a kind");
        let [frames @ .., last] = pages.clone();
        film.make(frames, last).expect("a film");
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("a folder").count(),
            1
        );

        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let reader = std::fs::File::open(&file).expect("a file");
        let mut decoder = options.read_info(reader).expect("a GIF");
        let mut screen = vec![0; 4 * 2 * 4];
        let mut delays = Vec::new();
        for page in &pages {
            let frame = decoder.read_next_frame().expect("sound").expect("a frame");
            delays.push(frame.delay);
            let [left, top] = [frame.left, frame.top].map(usize::from);
            let [width, height] = [frame.width, frame.height].map(usize::from);
            for row in 0..height {
                let at = 4 * ((top + row) * 4 + left);
                let from = 4 * row * width;
                screen[at..at + 4 * width].copy_from_slice(&frame.buffer[from..from + 4 * width]);
            }
            assert_eq!(screen, page.rgba);
        }
        assert!(decoder.read_next_frame().expect("sound").is_none());
        assert_eq!(delays, [10, 10, 10, 300]);
    }

    #[test]
    fn what_cannot_be_filmed_says_why() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        assert!(matches!(Film::new(&at("film.avi")), Err(FilmError::Kind)));
        let nowhere = Film::new(&at("no/such/film.gif")).expect("a kind");
        let failed = nowhere.make([], drawn(&["01", "23"]));
        assert!(matches!(failed, Err(FilmError::File(_))), "{failed:?}");
    }
}
