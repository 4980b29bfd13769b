//! Whole runs of the strategies that close loops (`ouroboros`) and patrol rails (`tdbvp`).

mod closed;
mod data;
mod full;
mod impatience;
mod limits;
mod overlay;
mod patrol;
mod sides;
mod slam;
mod sweep;
mod uneven;
