//! The image's budget: flash, memory, and no allocator, read from the ELF file.
//!
//! The limits are strict. `golden/size.txt` has the figures, compared within 5 %, because compilers
//! arrange the code differently.

use core::ops::Range;

use fieldline_planner::Workspace;
use fieldline_tests::elf::Image;
use fieldline_tests::table::Table;
use fieldline_tests::{costs, emulator, golden};

/// Flash that the image may take of the chip's 1 MB. Planes over scattered tiles took 7 KB of it,
/// and gave back 22 KB of the memory, which is scarce. Claims, shared trips, roll-outs and retreats
/// took 22 KB: that buys buildings in which the robot was stuck before. A codec built for size gave
/// back 25 KB. Corrections on uneven ground and those of a team's tiles took 2 KB. Fences, orders
/// to drive and a budget took 14 KB: only the chip can keep the hull off in recoveries and
/// retreats. The check of the wiring took 10 KB: it tells a first day's mistakes before the robot
/// drives on them. A start that touches nothing took 2 KB. One search for goals in every order gave
/// back 5 KB. What lies around a robot that was reset took 5 KB: it is back in a door as narrow as
/// itself. Bringing the beams of a lidar that turns to one instant took 3 KB: the hosts of such
/// lidars know no odometry between two scans better than the chip, and most lidars turn. Coded
/// tiles took 11 KB: half as much floor again fits into the memory.
const MOST_FLASH: u64 = 381 * 1024;
/// The chip's main memory.
const SRAM: Range<u64> = 0x2000_0000..0x2002_0000;
/// The chip's core-coupled memory, which holds the planner's workspace and nothing else.
const CCM: u64 = 64 * 1024;

fn image() -> Image {
    Image::read(&emulator::image()).expect("cargo built it a moment ago")
}

#[test]
#[ignore = "needs the image; tests/run runs it"]
fn the_image_is_within_its_budget() {
    let image = image();
    let workspace = size_of::<Workspace>() as u64;
    let mut table = Table::new(1, &["what", "bytes"]);
    for section in &image.sections {
        table.row(vec![section.name.clone(), section.size.to_string()]);
    }
    let stack = stack(&image);
    let (sram, flash) = (image.reserved(&SRAM) + stack, image.flash);
    for (what, bytes) in [
        ("flash", flash),
        ("stack", stack),
        ("SRAM", sram),
        ("CCM", workspace),
    ] {
        table.row(vec![what.into(), bytes.to_string()]);
    }
    golden::compare_about("size.txt", &table.to_string(), costs::DRIFT);
    assert!(flash > 0 && flash <= MOST_FLASH, "flash {flash}");
    assert!(sram > 0 && sram <= SRAM.end - SRAM.start, "SRAM {sram}");
    assert!(workspace <= CCM, "CCM {workspace}");
}

/// Returns the size of the stack, which the linker script reserves.
fn stack(image: &Image) -> u64 {
    let bounds = image
        .address("_stack_start")
        .zip(image.address("_stack_end"));
    let (start, end) = bounds.expect("memory.x says where the stack lies");
    assert!(SRAM.contains(&end) && end < start && start <= SRAM.end);
    start - end
}

/// The image has none of the functions that every allocation calls.
#[test]
#[ignore = "needs the image; tests/run runs it"]
fn the_image_has_no_allocator() {
    let image = image();
    let is_there = |name: &str| {
        image
            .symbols
            .iter()
            .any(|(symbol, _)| symbol.contains(name))
    };
    assert!(is_there("main"), "there are symbols to look at");
    for name in [
        "__rust_alloc",
        "__rg_alloc",
        "__rdl_alloc",
        "malloc",
        "alloc_error",
    ] {
        assert!(!is_there(name), "{name} is in the image");
    }
}

/// The emulator has memory where the chip has none.
#[test]
#[ignore = "needs the image; tests/run runs it"]
fn every_section_lies_where_the_chip_has_memory() {
    let image = image();
    for section in &image.sections {
        let end = section.address + section.size;
        let on_chip = end <= SRAM.end || !(SRAM.start..0x2004_0000).contains(&section.address);
        assert!(on_chip, "{} ends at {end:#x}", section.name);
    }
}
