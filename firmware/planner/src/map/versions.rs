//! The versions of the tiles, for a team: an epoch, and what the others were not told yet.
//!
//! - The *epoch* of a tile is raised when the robot says a tile in which a cell's class went down
//!   since it was said before ([`super::join`]).
//! - A correction of the map begins the next *era* of a tile, [`ERA`] epochs long: what others have
//!   of an earlier era is replaced and fills nothing. There are 63 of them; a tile that is
//!   corrected more often stays in the last one.
//! - A tile that the robot changed by its own measurement is *due* once it was left alone for 2 s,
//!   and after 4 s while it goes on to change. A join is no measurement.
//!
//! A map without a team keeps the marks too, and nobody reads them.
//!
//! A compact tile keeps its version in its code. It is not due, and asked for all the same.
//!
//! Units: sweeps, one a second.

use crate::grid::{inside, inside_mut};

/// Epoch of a tile that the robot measured. Epoch 0 is that of a tile that was moved with the map
/// into the team's coordinates: what others measured there counts more.
pub(crate) const MEASURED: u16 = 1;
/// Epochs of an era; a power of two. A robot that raises an epoch each 2 s takes half an hour.
pub(super) const ERA: u16 = 1024;
/// A cell changed since the last sweep.
const CHANGED: u8 = 1;
/// A cell's class went down since the tile was said.
const WENT_DOWN: u8 = 2;
/// Sweeps since the last change, 0 to 2, in two bits.
const QUIET: u8 = 4;
/// Sweeps since the first change that was not said, 0 to 4, in three bits.
const WAITING: u8 = 16;
/// Greatest number of sweeps that are counted.
const MOST_QUIET: u8 = 2;
const MOST_WAITING: u8 = 4;

/// What the team was not told of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct News(u8);

/// What the team knows of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Version {
    pub(super) epoch: u16,
    pub(super) news: News,
}

impl Version {
    /// The version of a tile that the robot begins.
    pub(super) const MEASURED: Self = Self {
        epoch: MEASURED,
        news: News(0),
    };

    /// Raises the epoch if a cell's class went down since the tile was said. Returns true then.
    const fn settle(&mut self) -> bool {
        let went_down = self.news.0 & WENT_DOWN != 0;
        if went_down {
            self.news.0 &= !WENT_DOWN;
            self.epoch = self.epoch.saturating_add(1);
        }
        went_down
    }

    /// Returns the version of a tile that is said.
    pub(super) const fn said(mut self) -> Self {
        self.settle();
        self.news = News(0);
        self
    }
}

impl News {
    /// Returns the bits.
    pub(super) const fn bits(self) -> u8 {
        self.0
    }

    /// Returns the news of some bits.
    pub(super) const fn of_bits(bits: u8) -> Self {
        Self(bits)
    }

    /// Notes a change of a cell's class, in the order unknown < free < obstacle < negative.
    #[inline(always)]
    pub(super) const fn note(&mut self, before: u32, after: u32) {
        if before != after {
            self.0 |= if after < before {
                CHANGED | WENT_DOWN
            } else {
                CHANGED
            };
        }
    }

    const fn quiet(self) -> u8 {
        self.0 % WAITING / QUIET
    }

    const fn waiting(self) -> u8 {
        self.0 / WAITING
    }

    /// Counts one sweep.
    fn sweep(&mut self) {
        let changed = self.0 & CHANGED != 0;
        if !changed && self.waiting() == 0 {
            return;
        }
        let quiet = if changed {
            0
        } else {
            (self.quiet() + 1).min(MOST_QUIET)
        };
        let waiting = (self.waiting() + 1).min(MOST_WAITING);
        self.0 = (self.0 & WENT_DOWN) + quiet * QUIET + waiting * WAITING;
    }

    /// Returns true if the tile is to be said now.
    const fn is_due(self) -> bool {
        self.quiet() == MOST_QUIET || self.waiting() == MOST_WAITING
    }
}

/// The versions of the tiles, by page.
#[derive(Debug)]
pub(super) struct Versions<const TILES: usize> {
    epochs: [u16; TILES],
    news: [News; TILES],
}

impl<const TILES: usize> Versions<TILES> {
    /// Returns epoch 0 everywhere, and no news.
    pub(super) const fn new() -> Self {
        Self {
            epochs: [0; TILES],
            news: [News(0); TILES],
        }
    }

    /// Begins a tile in a page.
    pub(super) fn begin(&mut self, page: usize) {
        self.put(page, Version::MEASURED);
    }

    /// Returns the version of the tile in a page.
    pub(super) fn of(&self, page: usize) -> Version {
        Version {
            epoch: self.epoch(page),
            news: inside(&self.news, page).copied().unwrap_or_default(),
        }
    }

    /// Gives the tile in a page a version.
    pub(super) fn put(&mut self, page: usize, version: Version) {
        self.set_epoch(page, version.epoch);
        if let Some(news) = self.news_mut(page) {
            *news = version.news;
        }
    }

    /// Begins a tile anew in its page: a correction replaced its cells, which were of the epoch
    /// `epoch`; `None` if it had none.
    pub(super) fn begin_corrected(&mut self, page: usize, epoch: Option<u16>) {
        let next = epoch.map_or(MEASURED, |epoch| epoch | (ERA - 1));
        self.set_epoch(page, next.saturating_add(1));
        if let Some(news) = self.news_mut(page) {
            *news = News(CHANGED);
        }
    }

    /// Begins all tiles anew: the map was moved. Their cells are news.
    pub(super) fn begin_moved(&mut self) {
        self.epochs.fill(0);
        self.news.fill(News(CHANGED));
    }

    /// Returns the news of a page.
    #[inline(always)]
    pub(super) fn news_mut(&mut self, page: usize) -> Option<&mut News> {
        inside_mut(&mut self.news, page)
    }

    /// Returns the epoch of a page.
    pub(super) fn epoch(&self, page: usize) -> u16 {
        inside(&self.epochs, page).map_or(MEASURED, |&epoch| epoch)
    }

    pub(super) fn set_epoch(&mut self, page: usize, epoch: u16) {
        if let Some(old) = inside_mut(&mut self.epochs, page) {
            *old = epoch;
        }
    }

    /// Raises the epoch of a page if a cell's class went down. Returns true then.
    pub(super) fn settle(&mut self, page: usize) -> bool {
        let mut version = self.of(page);
        let went_down = version.settle();
        if went_down {
            self.put(page, version);
        }
        went_down
    }

    /// Counts one sweep of all pages. Call it once a second.
    pub(super) fn sweep(&mut self) {
        self.news.iter_mut().for_each(News::sweep);
    }

    /// Returns true if a page is to be said now.
    pub(super) fn is_due(&self, page: usize) -> bool {
        inside(&self.news, page).is_some_and(|news| news.is_due())
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{ERA, MEASURED, Versions};

    /// Returns the sweeps after which a page is due that changes before these sweeps.
    fn due(changes: &[usize]) -> Vec<usize> {
        let mut versions = Versions::<2>::new();
        let mut due = Vec::new();
        for sweep in 0..12 {
            if changes.contains(&sweep) {
                versions.news_mut(1).unwrap().note(0, 1);
            }
            versions.sweep();
            if versions.is_due(1) {
                due.push(sweep);
                versions.put(1, versions.of(1).said());
            }
            assert!(!versions.is_due(0));
        }
        due
    }

    #[test]
    fn a_page_is_due_after_two_quiet_seconds_or_four_restless_ones() {
        assert_eq!(due(&[]), Vec::<usize>::new());
        assert_eq!(due(&[0]), [2]);
        assert_eq!(due(&[0, 2]), [3]);
        assert_eq!(due(&[0, 1, 2, 3, 4, 5, 6]), [3, 7]);
    }

    #[test]
    fn a_correction_begins_an_era_and_a_new_tile_needs_none() {
        let mut versions = Versions::<1>::new();
        let mut corrected = |epoch| {
            versions.begin_corrected(0, epoch);
            versions.epoch(0)
        };
        assert_eq!(corrected(None), MEASURED + 1);
        let first = corrected(Some(MEASURED));
        assert_eq!([first, corrected(Some(first + 5))], [ERA, 2 * ERA]);
        assert_eq!(corrected(Some(u16::MAX - 3)), u16::MAX);
    }

    #[test]
    fn only_a_class_that_went_down_raises_the_epoch_and_only_once() {
        let mut versions = Versions::<1>::new();
        versions.begin(0);
        versions.news_mut(0).unwrap().note(0, 2);
        versions.put(0, versions.of(0).said());
        assert_eq!(versions.epoch(0), MEASURED);
        versions.news_mut(0).unwrap().note(2, 1);
        versions.news_mut(0).unwrap().note(2, 1);
        versions.sweep();
        versions.put(0, versions.of(0).said());
        assert_eq!(versions.epoch(0), MEASURED + 1);
        versions.put(0, versions.of(0).said());
        assert_eq!(versions.epoch(0), MEASURED + 1);
    }
}
