//! The price of a straight run of instructions in the core, as if each were executed: cycles
//! without the waits for flash and without the refill after taken branches.
//!
//! Prices are those of the Cortex-M4 Technical Reference Manual (ARM 100166), tables of section 3.3
//! and of the FPU's chapter. Where it leaves a range, `docs/CYCLES.md` says what measured programs
//! decided. Invariant: the cycles of a run are the sum of those of its instructions. Unit: cycles.

use crate::instruction::{Class, Instruction};

/// SDIV and UDIV: 2 to 12 by the operands, which nobody sees here.
const DIVIDE: u32 = 6;
/// VMLA, VFMA and their kin.
const MULTIPLY_ADD: u32 = 3;
/// VDIV and VSQRT, beside which integer instructions run.
const FP_DIVIDE: u32 = 14;
/// Wait of an FPU instruction right behind the one that computes its operand.
const FP_OPERAND: u32 = 1;
/// VLDR never pipelines with its neighbours. Fitted.
const FP_LOAD: u32 = 2;
/// A load that does not pipeline with the load before it.
const LOAD: u32 = 2;
/// Wait of a load right behind a buffered store. A store there waits for nothing. Fitted.
const LOAD_BEHIND_STORE: u32 = 1;
/// MSR, MRS, CPS.
const SYSTEM: u32 = 2;
/// Barriers, by the words that they wait for in the image.
const BARRIER: u32 = 4;
/// TBB and TBH, before the refill.
const TABLE: u32 = 2;

/// Refill of the pipeline after a taken branch whose target is in the instruction. Fitted.
pub(crate) const REFILL_DIRECT: u32 = 1;
/// The same for targets that come from a register or from memory. Fitted.
pub(crate) const REFILL_INDIRECT: u32 = 2;
/// More, if the target is a wide instruction across two words. Fitted.
pub(crate) const REFILL_SPLIT: u32 = 1;
/// Entry into an exception.
pub(crate) const EXCEPTION: u32 = 12;

/// The price of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// Cycles of each instruction.
    pub cycles: Vec<u32>,
    /// Cycles from the start to the first instruction that waits for the FPU, if there is one.
    pub first_fp: Option<u32>,
    /// Cycles for which the FPU divides on after the end.
    pub divides_on: u32,
}

impl Run {
    /// Prices a run.
    #[must_use]
    pub fn of(instructions: &[Instruction]) -> Self {
        let mut pricing = Pricing::default();
        let mut cycles = Vec::with_capacity(instructions.len());
        for instruction in instructions {
            cycles.push(pricing.next(instruction));
        }
        Self {
            cycles,
            first_fp: pricing.first_fp,
            divides_on: pricing.divided.saturating_sub(pricing.now),
        }
    }
}

/// What is known while a run is priced.
#[derive(Default)]
struct Pricing {
    /// Cycles since the start.
    now: u32,
    /// When the FPU has divided.
    divided: u32,
    first_fp: Option<u32>,
    before: Option<Instruction>,
}

impl Pricing {
    /// Returns the cycles of the next instruction.
    fn next(&mut self, instruction: &Instruction) -> u32 {
        let wait = self.wait_for_fpu(instruction);
        if instruction.class == Class::FpDivide {
            self.divided = self.now + wait + FP_DIVIDE;
        }
        let cycles = wait + self.own(instruction);
        self.now += cycles;
        self.before = Some(*instruction);
        cycles
    }

    /// Returns the wait for a division, or for an operand that comes a cycle late.
    fn wait_for_fpu(&mut self, instruction: &Instruction) -> u32 {
        if !instruction.uses_fpu() {
            return 0;
        }
        self.first_fp.get_or_insert(self.now);
        if self.divided > self.now {
            return self.divided - self.now;
        }
        let comes_late = self.before.is_some_and(|before| {
            let computes = matches!(
                before.class,
                Class::FpArithmetic | Class::FpMultiplyAdd | Class::FpDivide
            );
            computes && before.fp_writes & instruction.fp_reads != 0
        });
        if comes_late { FP_OPERAND } else { 0 }
    }

    /// Returns what an instruction takes behind the one before it.
    fn own(&self, instruction: &Instruction) -> u32 {
        let before = self.before.map(|before| before.class);
        let stored = matches!(before, Some(Class::StoreImmediate | Class::FpStore));
        let behind_store = if stored { LOAD_BEHIND_STORE } else { 0 };
        // A load before pipelines with this one unless it gives the address.
        let pipelines = self
            .before
            .is_some_and(|it| it.class == Class::Load && it.loads & instruction.address == 0);
        match instruction.class {
            Class::Load if pipelines => behind_store + 1,
            Class::Load => behind_store + LOAD,
            Class::FpLoad => behind_store + FP_LOAD,
            Class::StoreRegister if !pipelines => 2,
            Class::Multiple { words, load: true } => behind_store + 1 + u32::from(words),
            Class::Multiple { words, load: false } => 1 + u32::from(words),
            Class::BranchLoad { words } => behind_store + 1 + u32::from(words),
            Class::BranchTable => behind_store + TABLE,
            Class::Divide => DIVIDE,
            Class::IfThen if self.before.is_some_and(|it| it.bytes == 2) => 0,
            Class::FpMultiplyAdd => MULTIPLY_ADD,
            Class::FpMoveTwo => 2,
            Class::System => SYSTEM,
            Class::Barrier => BARRIER,
            Class::Alu
            | Class::IfThen
            | Class::StoreImmediate
            | Class::StoreRegister
            | Class::FpStore
            | Class::FpArithmetic
            | Class::FpDivide
            | Class::FpMove
            | Class::Branch
            | Class::BranchRegister
            | Class::Wait
            | Class::Unknown => 1,
        }
    }
}

/// Returns the cycles by which a misaligned access is longer. `size` is the binary logarithm of its
/// bytes. A word at an odd halfword is two accesses, at an odd byte three.
#[must_use]
pub const fn misaligned(address: u32, size: u32) -> u32 {
    match (size, address & 3) {
        (2, 2) | (1, 1 | 3) => 1,
        (2, 1 | 3) => 2,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::{Run, misaligned};
    use crate::decode::{narrow, wide};
    use crate::instruction::Instruction;

    fn cycles(run: &[Instruction]) -> Vec<u32> {
        Run::of(run).cycles
    }

    #[test]
    fn neighbouring_loads_pipeline_unless_one_gives_the_address() {
        let load_r0 = narrow(0x6810); // ldr r0, [r2]
        let load_r1 = narrow(0x6819); // ldr r1, [r3]
        let chained = narrow(0x6801); // ldr r1, [r0]
        assert_eq!(cycles(&[load_r0, load_r1]), [2, 1]);
        assert_eq!(cycles(&[load_r0, chained]), [2, 2]);
    }

    #[test]
    fn stores_are_buffered() {
        let (store, load, add) = (narrow(0x6010), narrow(0x6819), narrow(0x1840));
        assert_eq!(cycles(&[store, store, add]), [1, 1, 1]);
        assert_eq!(cycles(&[store, load]), [1, 3]);
    }

    #[test]
    fn integer_instructions_hide_a_division_of_the_fpu() {
        let divide = wide(0xee80, 0x0a20); // vdiv.f32 s0, s0, s1
        let add = wide(0xee30, 0x1a21); // vadd.f32 s2, s0, s3
        let integer = narrow(0x1840);
        assert_eq!(cycles(&[divide, add]), [1, 14]);
        assert_eq!(cycles(&[divide, integer, integer, add]), [1, 1, 1, 12]);
        let left = Run::of(&[integer, divide, integer]);
        assert_eq!((left.divides_on, left.first_fp), (12, Some(1)));
    }

    #[test]
    fn a_result_of_the_fpu_comes_a_cycle_late() {
        let multiply = wide(0xee21, 0x1a22); // vmul.f32 s2, s2, s5
        let add = wide(0xee31, 0x0a20); // vadd.f32 s0, s2, s1
        let other = wide(0xee33, 0x3a23); // vadd.f32 s6, s6, s7
        assert_eq!(cycles(&[multiply, add]), [1, 2]);
        assert_eq!(cycles(&[multiply, other, add]), [1, 1, 1]);
    }

    #[test]
    fn a_condition_folds_into_a_narrow_instruction() {
        let (if_then, add, wide_add) = (narrow(0xbf08), narrow(0x1840), wide(0xeb00, 0x0001));
        assert_eq!(cycles(&[add, if_then]), [1, 0]);
        assert_eq!(cycles(&[wide_add, if_then]), [1, 1]);
    }

    #[test]
    fn a_misaligned_access_is_split() {
        assert_eq!(misaligned(0x2000_0000, 2), 0);
        assert_eq!(misaligned(0x2000_0002, 2), 1);
        assert_eq!(misaligned(0x2000_0001, 2), 2);
        assert_eq!(misaligned(0x2000_0001, 1), 1);
        assert_eq!(misaligned(0x2000_0003, 0), 0);
    }
}
