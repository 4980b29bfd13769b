//! What an instruction does to the stack and to the flow of control: ARMv7-M Architecture Reference
//! Manual, chapters A5 to A7.
//!
//! Only such instructions are decoded. Every other one is [`Effect::None`], and its length is known
//! from its first halfword. An instruction that sets the stack pointer in a way that has no fixed
//! size is [`Effect::SetsStack`], never `None`. Units: bytes.

/// Number of the stack pointer among the registers.
const SP: u16 = 13;
/// Number of the link register: a jump to it is a return.
const LR: u16 = 14;
/// Number of the program counter: a load into it is a jump.
const PC: u16 = 15;

/// Effect of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    /// Neither stack nor a call; or the stack shrinks, or the function returns.
    None,
    /// The stack grows by a fixed number of bytes.
    Grows(u32),
    /// The stack pointer gets a value that the instruction does not hold.
    SetsStack,
    /// A call of the function at an address.
    Calls(u32),
    /// A call of an address in a register.
    CallsRegister,
    /// A jump to an address, whether conditional or not.
    Jumps(u32),
    /// A jump to an address in a register or in memory.
    JumpsRegister,
    /// A register gets these lower 16 bits, and zeros above them.
    SetsLow(u16, u16),
    /// A register gets these upper 16 bits.
    SetsHigh(u16, u16),
}

/// Decodes the instruction at `address`, of the halfwords `first` and `second`. Returns its length
/// and its effect.
pub(crate) fn decode(address: u32, first: u16, second: u16) -> (u32, Effect) {
    if first >> 11 >= 0b11101 {
        (4, wide(address, first, second))
    } else {
        (2, narrow(address, first))
    }
}

/// Decodes an instruction of 16 bits.
fn narrow(address: u32, code: u16) -> Effect {
    let to = |offset: i32| Effect::Jumps(address.wrapping_add(4).wrapping_add_signed(offset));
    let low = u32::from(code & 0xff);
    match code {
        // PUSH: eight low registers and the link register.
        _ if code & 0xfe00 == 0xb400 => Effect::Grows(4 * (code & 0x1ff).count_ones()),
        // SUB SP, SP, #imm7
        _ if code & 0xff80 == 0xb080 => Effect::Grows(4 * (low & 0x7f)),
        // ADD and MOV with high registers.
        _ if code & 0xfd00 == 0x4400 => match (code >> 4 & 8) | code & 7 {
            SP => Effect::SetsStack,
            PC => Effect::JumpsRegister,
            _ => Effect::None,
        },
        // BX, BLX
        _ if code & 0xff87 == 0x4700 && code >> 3 & 15 != LR => Effect::JumpsRegister,
        _ if code & 0xff87 == 0x4780 => Effect::CallsRegister,
        // CBZ, CBNZ
        _ if code & 0xf500 == 0xb100 => to(i32::from((code >> 3 & 31) << 1 | (code >> 9 & 1) << 6)),
        // B with a condition; 14 and 15 are other instructions.
        _ if code & 0xf000 == 0xd000 && code >> 8 & 15 < 14 => to(signed(low << 1, 9)),
        // B
        _ if code & 0xf800 == 0xe000 => to(signed(u32::from(code & 0x7ff) << 1, 12)),
        _ => Effect::None,
    }
}

/// Decodes an instruction of 32 bits.
fn wide(address: u32, first: u16, second: u16) -> Effect {
    let into = second >> 8 & 15;
    match first {
        // STMDB SP!
        0xe92d => Effect::Grows(4 * second.count_ones()),
        // STR Rt, [SP, #-imm8]!
        0xf84d if second & 0x0f00 == 0x0d00 => Effect::Grows(u32::from(second & 0xff)),
        // STRD Rt, Rt2, [SP, #-imm8]!
        0xe96d => Effect::Grows(4 * u32::from(second & 0xff)),
        // VPUSH
        _ if first & 0xffbf == 0xed2d && second & 0x0e00 == 0x0a00 => {
            Effect::Grows(4 * u32::from(second & 0xff))
        }
        // Data processing with an immediate.
        _ if first & 0xf800 == 0xf000 && second & 0x8000 == 0 && into == SP => {
            immediate(first, second)
        }
        // MOVW, MOVT
        _ if matches!(first & 0xfbf0, 0xf240 | 0xf2c0) && second & 0x8000 == 0 => {
            let value = (first & 15) << 12 | halfword(first, second);
            match first & 0x80 {
                0 => Effect::SetsLow(into, value),
                _ => Effect::SetsHigh(into, value),
            }
        }
        // Data processing with a shifted register.
        _ if first & 0xfe00 == 0xea00 && into == SP => Effect::SetsStack,
        // MSR to the main or the process stack pointer.
        _ if first & 0xffe0 == 0xf380 && second >> 12 == 8 && matches!(second & 0xff, 8 | 9) => {
            Effect::SetsStack
        }
        // LDR of a word.
        _ if matches!(first & 0xfff0, 0xf850 | 0xf8d0) && second >> 12 == SP => Effect::SetsStack,
        _ if matches!(first & 0xfff0, 0xf850 | 0xf8d0) && second >> 12 == PC => {
            // LDR PC, [SP], #4 is a return.
            let returns = first == 0xf85d && second & 0x0fff == 0x0b04;
            if returns {
                Effect::None
            } else {
                Effect::JumpsRegister
            }
        }
        _ if first & 0xf800 == 0xf000 && second & 0x8000 != 0 => branch(address, first, second),
        _ => Effect::None,
    }
}

/// Decodes data processing with an immediate, of which the result goes to the stack pointer.
fn immediate(first: u16, second: u16) -> Effect {
    let immediate = u32::from(halfword(first, second));
    match first & 0xfbef {
        // SUB SP, SP: a value of eight bits that may be rotated, or 12 bits.
        0xf1ad => Effect::Grows(expanded(immediate)),
        0xf2ad => Effect::Grows(immediate),
        // ADD SP, SP
        0xf10d | 0xf20d => Effect::None,
        _ => Effect::SetsStack,
    }
}

/// Returns the immediate of 12 bits that lies in three parts of an instruction.
const fn halfword(first: u16, second: u16) -> u16 {
    second & 0xff | (second >> 12 & 7) << 8 | (first >> 10 & 1) << 11
}

/// Decodes branches with a link, without one, and with a condition.
fn branch(address: u32, first: u16, second: u16) -> Effect {
    let bit = |word: u16, k: u16| u32::from(word >> k & 1);
    let sign = bit(first, 10);
    let to = |offset: u32, bits: u32| {
        address
            .wrapping_add(4)
            .wrapping_add_signed(signed(offset, bits))
    };
    // BL and B: 25 bits; J1 and J2 hold the sign, exclusive-or'ed and inverted.
    let far = || {
        let [one, two] = [13, 11].map(|k| bit(second, k) ^ sign ^ 1);
        let high = sign << 24 | one << 23 | two << 22;
        to(
            high | u32::from(first & 0x3ff) << 12 | u32::from(second & 0x7ff) << 1,
            25,
        )
    };
    match second & 0xd000 {
        0xd000 => Effect::Calls(far()),
        0x9000 => Effect::Jumps(far()),
        // B with a condition: 21 bits.
        0x8000 if first >> 6 & 15 < 14 => {
            let high = sign << 20 | bit(second, 11) << 19 | bit(second, 13) << 18;
            let low = u32::from(first & 0x3f) << 12 | u32::from(second & 0x7ff) << 1;
            Effect::Jumps(to(high | low, 21))
        }
        _ => Effect::None,
    }
}

/// Returns the value of an immediate of 12 bits in the encoding of the manual (A5.3.2).
fn expanded(immediate: u32) -> u32 {
    let byte = immediate & 0xff;
    match immediate >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte * 0x0101_0101,
        _ => (immediate & 0x7f | 0x80).rotate_right(immediate >> 7),
    }
}

/// Returns the low `bits` of `value` as a signed number.
const fn signed(value: u32, bits: u32) -> i32 {
    (value << (32 - bits)) as i32 >> (32 - bits)
}

#[cfg(test)]
mod tests {
    use super::{Effect, decode};

    /// Instructions as an assembler wrote them, with the effects that the manual gives.
    #[test]
    fn instructions_have_the_effects_of_the_manual() {
        let cases: &[(u16, u16, Effect)] = &[
            (0xb5f0, 0, Effect::Grows(20)),                // push {r4-r7, lr}
            (0xe92d, 0x0f00, Effect::Grows(16)),           // stmdb sp!, {r8-r11}
            (0xf84d, 0xbd04, Effect::Grows(4)),            // str.w r11, [sp, #-4]!
            (0xed2d, 0x8b10, Effect::Grows(64)),           // vpush {d8-d15}
            (0xb087, 0, Effect::Grows(28)),                // sub sp, #28
            (0xf5ad, 0x5da4, Effect::Grows(0x1480)),       // sub.w sp, sp, #5248
            (0xf6ad, 0x5d48, Effect::Grows(0xd48)),        // subw sp, sp, #3400
            (0xf5ad, 0x7d57, Effect::Grows(0x35c)),        // sub.w sp, sp, #860
            (0x468d, 0, Effect::SetsStack),                // mov sp, r1
            (0x46bd, 0, Effect::SetsStack),                // mov sp, r7
            (0xf1a7, 0x0d10, Effect::SetsStack),           // sub.w sp, r7, #16
            (0xebad, 0x0d02, Effect::SetsStack),           // sub.w sp, sp, r2
            (0xf381, 0x8808, Effect::SetsStack),           // msr msp, r1
            (0xb005, 0, Effect::None),                     // add sp, #20
            (0x4770, 0, Effect::None),                     // bx lr
            (0xf85d, 0xfb04, Effect::None),                // ldr pc, [sp], #4
            (0x4718, 0, Effect::JumpsRegister),            // bx r3
            (0x47c8, 0, Effect::CallsRegister),            // blx r9
            (0xf000, 0xf802, Effect::Calls(0x1008)),       // bl +8
            (0xf7ff, 0xfffe, Effect::Calls(0x1000)),       // bl +0
            (0xf7ff, 0xbffe, Effect::Jumps(0x1000)),       // b.w +0
            (0xf43f, 0xaffe, Effect::Jumps(0x1000)),       // beq.w +0
            (0xe7fe, 0, Effect::Jumps(0x1000)),            // b.n +0
            (0xd0fe, 0, Effect::Jumps(0x1000)),            // beq.n +0
            (0xb108, 0, Effect::Jumps(0x1006)),            // cbz r0, +6
            (0xf248, 0x3a45, Effect::SetsLow(10, 0x8345)), // movw r10, #0x8345
            (0xf6c0, 0x0103, Effect::SetsHigh(1, 0x0803)), // movt r1, #0x0803
            (0xdf01, 0, Effect::None),                     // svc 1
            (0xbf30, 0, Effect::None),                     // wfi
            (0xf3bf, 0x8f4f, Effect::None),                // dsb
            (0xf380, 0x0008, Effect::None),                // usat r0, #8, r0
        ];
        for &(first, second, effect) in cases {
            let (length, found) = decode(0x1000, first, second);
            assert_eq!(found, effect, "{first:04x} {second:04x}");
            assert_eq!(length, if first >> 11 >= 0b11101 { 4 } else { 2 });
        }
    }
}
