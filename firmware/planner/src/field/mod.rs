//! The potential in the local window.
