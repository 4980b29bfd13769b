//! The skeleton of the traversable space and distances along it.
