//! Instructions of the FPU: `ARMv7-M` Architecture Reference Manual (DDI 0403), A6.
//!
//! `FPv4-SP` computes with single registers only. Double registers are loaded, stored and moved.

use crate::instruction::{Class, Instruction, set};

/// A single register: four bits of its number, and the lowest one elsewhere in the instruction.
const fn single(high: u32, low: u32) -> u32 {
    1 << ((high & 15) << 1 | low & 1)
}

/// A double register of the lower sixteen, as the set of its two single registers.
const fn double(number: u32) -> u32 {
    0b11 << ((number & 15) << 1)
}

/// Decodes a wide instruction `0xecxx`, `0xedxx` or `0xeexx` with its second halfword.
pub(super) fn decode(a: u32, b: u32) -> Instruction {
    let is_double = match b >> 8 & 15 {
        10 => false,
        11 => true,
        _ => return Instruction::new(Class::Unknown, 4),
    };
    match a & 0xffe0 {
        0xec40 => move_two(a, b, is_double),
        _ if a & 0xfe00 == 0xec00 => transfer(a, b, is_double),
        _ if a & 0xff00 != 0xee00 => Instruction::new(Class::Unknown, 4),
        _ if b & 0x10 != 0 => move_one(a, b),
        _ => compute(a, b),
    }
}

/// Returns `instruction` with the registers that it reads, if it moves to the core or to memory, or
/// else with those that it writes.
fn with(instruction: Instruction, reads: bool, registers: u32) -> Instruction {
    match reads {
        true => Instruction {
            fp_reads: registers,
            ..instruction
        },
        false => Instruction {
            fp_writes: registers,
            ..instruction
        },
    }
}

/// Decodes VMOV between two core registers and a double register or two single ones.
fn move_two(a: u32, b: u32, is_double: bool) -> Instruction {
    let first = single(b, b >> 5);
    let registers = if is_double {
        double(b)
    } else {
        first | first << 1
    };
    let to_core = a & 0x10 != 0;
    with(Instruction::new(Class::FpMoveTwo, 4), to_core, registers)
}

/// Decodes VLDR, VSTR, VLDM and VSTM, and so VPUSH and VPOP.
fn transfer(a: u32, b: u32, is_double: bool) -> Instruction {
    let load = a & 0x10 != 0;
    let first = if is_double {
        double(b >> 12)
    } else {
        single(b >> 12, a >> 6)
    };
    let is_one = a & 0x0120 == 0x0100;
    let (class, registers) = match (is_one, is_double, load) {
        (true, false, true) => (Class::FpLoad, first),
        (true, false, false) => (Class::FpStore, first),
        (true, true, _) => (Class::Multiple { words: 2, load }, first),
        (false, ..) => {
            let words = (b & 0xff) as u8;
            let lowest = u64::from(first).trailing_zeros();
            let run = ((1u64 << words.min(32)) - 1) << lowest;
            (Class::Multiple { words, load }, run as u32)
        }
    };
    with(Instruction::access(class, 4, 0, set(a)), !load, registers)
}

/// Decodes VMOV of one core register, VMRS and VMSR.
fn move_one(a: u32, b: u32) -> Instruction {
    let instruction = Instruction::new(Class::FpMove, 4);
    match a & 0xffe0 {
        0xee00 => with(instruction, a & 0x10 != 0, single(a, b >> 7)),
        _ => instruction,
    }
}

/// Decodes what the FPU computes.
fn compute(a: u32, b: u32) -> Instruction {
    let destination = single(b >> 12, a >> 6);
    let (left, right) = (single(a, b >> 7), single(b, b >> 5));
    let (class, reads) = match a >> 4 & 0b1011 {
        // The addend is needed late, so nobody waits for it.
        0b0000 | 0b0001 | 0b1001 | 0b1010 => (Class::FpMultiplyAdd, left | right),
        0b0010 | 0b0011 => (Class::FpArithmetic, left | right),
        0b1000 => (Class::FpDivide, left | right),
        0b1011 => return unary(a, b, destination, right),
        _ => (Class::Unknown, 0),
    };
    Instruction {
        fp_reads: reads,
        fp_writes: destination,
        ..Instruction::new(class, 4)
    }
}

/// Decodes what has one operand, and VCMP.
fn unary(a: u32, b: u32, destination: u32, operand: u32) -> Instruction {
    let make = |class, reads, writes| Instruction {
        fp_reads: reads,
        fp_writes: writes,
        ..Instruction::new(class, 4)
    };
    let is_immediate = b & 0x40 == 0;
    match (a & 15, b & 0x80 != 0) {
        _ if is_immediate => make(Class::FpMove, 0, destination),
        (0, _) | (1, false) => make(Class::FpMove, operand, destination),
        (1, true) => make(Class::FpDivide, operand, destination),
        (4, _) => make(Class::FpMove, destination | operand, 0),
        // With zero.
        (5, _) => make(Class::FpMove, destination, 0),
        // Between fixed point and float, in place.
        (10 | 11 | 14 | 15, _) => make(Class::FpArithmetic, destination, destination),
        _ => make(Class::FpArithmetic, operand, destination),
    }
}

#[cfg(test)]
mod tests {
    use super::decode;
    use crate::instruction::Class;

    #[test]
    fn arithmetic_has_its_registers() {
        for (a, b, class, reads, writes) in [
            (0xee30, 0x1a21, Class::FpArithmetic, 0b1001, 0b100), // vadd.f32 s2, s0, s3
            (0xee80, 0x0a20, Class::FpDivide, 0b11, 0b1),         // vdiv.f32 s0, s0, s1
            (0xee01, 0x0a82, Class::FpMultiplyAdd, 0b1_1000, 0b1), // vmla.f32 s0, s3, s4
            (0xeeb1, 0x0ae0, Class::FpDivide, 0b10, 0b1),         // vsqrt.f32 s0, s1
            (0xeeb4, 0x0a60, Class::FpMove, 0b11, 0),             // vcmp.f32 s0, s1
            (0xeeb7, 0x0a00, Class::FpMove, 0, 0b1),              // vmov.f32 s0, #1.0
            (0xeef1, 0xfa10, Class::FpMove, 0, 0),                // vmrs APSR_nzcv, fpscr
            (0xee10, 0x0a90, Class::FpMove, 0b10, 0),             // vmov r0, s1
            (0xed90, 0x0a00, Class::FpLoad, 0, 0b1),              // vldr s0, [r0]
            (0xed80, 0x0a00, Class::FpStore, 0b1, 0),             // vstr s0, [r0]
            (0xec51, 0x0b10, Class::FpMoveTwo, 0b11, 0),          // vmov r0, r1, d0
        ] {
            let it = decode(a, b);
            let expected = (class, reads, writes, 4);
            assert_eq!(
                (it.class, it.fp_reads, it.fp_writes, it.bytes),
                expected,
                "{a:#x} {b:#x}"
            );
        }
    }

    #[test]
    fn a_push_of_many_registers_has_all_of_them() {
        let push = decode(0xed2d, 0x8b04); // vpush {d8, d9}
        assert_eq!(
            push.class,
            Class::Multiple {
                words: 4,
                load: false
            }
        );
        assert_eq!(push.fp_reads, 0xf << 16);
        assert!(push.is_on_stack() && push.uses_fpu());
    }
}
