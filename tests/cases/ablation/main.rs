//! Ablation of every tuned constant: the tables of `docs/ABLATION.md`, one case a room, and of
//! the rules that close loops.
//!
//! `ABLATION_RUNS=4` makes only the first four runs of a room.

mod closing;

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use fieldline_tests::ablation::rooms::ROOMS;
use fieldline_tests::ablation::store::Store;
use fieldline_tests::{ablation, golden};

/// Held by the room that runs: each takes all cores, and all write one page.
static LOCK: Mutex<()> = Mutex::new(());

fn check(name: &str) {
    let _guard = LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let room = ROOMS.iter().find(|room| room.name == name);
    let room = room.unwrap_or_else(|| panic!("no room is called {name}"));
    let most = std::env::var("ABLATION_RUNS").ok();
    let most = most.and_then(|most| most.parse().ok());
    let room = &room.with_first(most.unwrap_or(usize::MAX));
    let store = match Store::open(Path::new(env!("CARGO_TARGET_TMPDIR"))) {
        Ok(store) => store,
        Err(error) => panic!("no store of outcomes: {error}"),
    };
    let text = ablation::page::part(room, &ablation::of(room, &store));
    golden::compare_with_docs(&format!("ablation-{name}"), &text);
}

#[test]
#[ignore = "takes an hour: 1000 runs"]
fn ground() {
    check("ground");
}

#[test]
#[ignore = "takes minutes"]
fn map() {
    check("map");
}

#[test]
#[ignore = "takes minutes"]
fn localise() {
    check("localise");
}

#[test]
#[ignore = "takes minutes"]
fn field() {
    check("field");
}

#[test]
#[ignore = "takes minutes"]
fn tdbvp() {
    check("tdbvp");
}

#[test]
#[ignore = "takes minutes"]
fn ouroboros() {
    check("ouroboros");
}

#[test]
#[ignore = "takes minutes"]
fn sbpf() {
    check("sbpf");
}
