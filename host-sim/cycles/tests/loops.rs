//! Two loops whose prices are counted by hand: they pin the model.

use fieldline_cycles::chip::{Access, Chip};
use fieldline_cycles::decode::decode;
use fieldline_cycles::instruction::Instruction;

/// Turns of a loop.
const TURNS: u64 = 1000;
/// Where the loops lie: at the start of a line.
const START: u32 = 0x0800_1000;

fn instructions(halfwords: &[u16]) -> Vec<Instruction> {
    let bytes: Vec<u8> = halfwords.iter().flat_map(|it| it.to_le_bytes()).collect();
    let mut rest = bytes.as_slice();
    let mut decoded = Vec::new();
    while let Some(instruction) = decode(rest) {
        decoded.push(instruction);
        rest = &rest[usize::from(instruction.bytes)..];
    }
    assert!(rest.is_empty());
    decoded
}

/// Runs a loop of one block, which loads data from `reads` in every turn. Returns the cycles.
fn run(halfwords: &[u16], reads: &[u32]) -> u64 {
    let mut chip = Chip::default();
    let block = chip.block(START, &instructions(halfwords));
    for _ in 0..TURNS {
        chip.execute(block);
        for &address in reads {
            chip.access(&Access {
                block,
                index: 0,
                address,
                size: 2,
                store: false,
            });
        }
    }
    chip.counts().cycles
}

/// Copies words with a table of the flash in between.
#[test]
fn a_loop_of_integers_costs_what_the_manual_says() {
    let code = [
        0x6801, // ldr r1, [r0]         2
        0x6842, // ldr r2, [r0, #4]     1: pipelines with the load before
        0x1889, // adds r1, r1, r2      1
        0x680b, // ldr r3, [r1]         2
        0x681c, // ldr r4, [r3]         2: its address comes from the load before
        0x601c, // str r4, [r3]         1: buffered
        0x6858, // ldr r0, [r3, #4]     3: behind a store
        0xfb94, 0xf4f3, // sdiv r4, r4, r3  6
        0x3d01, // subs r5, #1          1
        0xd1f5, // bne                  1, and 1 to refill
    ];
    // Twenty-two bytes: two lines. The first line waits 5 cycles. The second one comes 6 cycles
    // later, and the core needs it after the 14 cycles of the first.
    let turn = 2 + 1 + 1 + 2 + 2 + 1 + 3 + 6 + 1 + 1;
    assert_eq!(run(&code, &[]), TURNS * turn + (TURNS - 1) + 5);
    // A table of one line: one more wait for the whole loop. The address is not in the code.
    assert_eq!(
        run(&code, &[0x0808_0000]),
        TURNS * turn + (TURNS - 1) + 5 + 5
    );
    // A word at an odd halfword of the memory: a cycle more in every turn.
    assert_eq!(
        run(&code, &[0x2000_0002]),
        TURNS * (turn + 1) + (TURNS - 1) + 5
    );
}

/// A row of a relaxation: loads, a multiply-add, a division beside integers.
#[test]
fn a_loop_of_floats_costs_what_the_manual_says() {
    let code = [
        0xed90, 0x0a00, // vldr s0, [r0]         2
        0xedd0, 0x0a01, // vldr s1, [r0, #4]     2: never pipelines
        0xee30, 0x1a20, // vadd.f32 s2, s0, s1   1
        0xee21, 0x1a01, // vmul.f32 s2, s2, s2   1, and 1 to wait for s2
        0xee01, 0x1a20, // vmla.f32 s2, s2, s1   3, and 1 to wait for s2
        0xee81, 0x2a20, // vdiv.f32 s4, s2, s1   1, and 1 to wait for s2; divides for 14
        0x3004, // adds r0, #4                   1: beside the division
        0x3104, // adds r1, #4                   1
        0xed81, 0x2a00, // vstr s4, [r1]         1, and 11 to wait for the division
        0x3d01, // subs r5, #1                   1
        0xd1ed, // bne                           1, and 1 to refill
    ];
    let turn = 2 + 2 + 1 + 2 + 4 + 2 + 1 + 1 + 12 + 1 + 1;
    // Thirty-six bytes: three lines. The first waits 5 cycles. The second one is used after 7
    // cycles of the first and came after 6. The third one comes in time as well.
    assert_eq!(run(&code, &[]), TURNS * turn + (TURNS - 1) + 5);
}
