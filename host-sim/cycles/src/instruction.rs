//! One instruction, as far as its price is concerned: class, length, and the registers for which a
//! neighbour may wait.
//!
//! Register sets are bit masks: bit `n` of a core set is `r`n, bit `n` of an FPU set is `s`n.

/// What decides the price of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Arithmetic, logic, shifts, multiplications, hints.
    Alu,
    /// A load of one register: neighbouring loads pipeline.
    Load,
    /// A store with an immediate offset.
    StoreImmediate,
    /// A store with a register offset, and STREX.
    StoreRegister,
    /// LDM, STM, PUSH, POP, LDRD, STRD, VLDM, VSTM, and VLDR or VSTR of a double register.
    Multiple {
        /// Number of words.
        words: u8,
        /// False if it stores.
        load: bool,
    },
    /// SDIV, UDIV.
    Divide,
    /// IT, which folds into a narrow predecessor.
    IfThen,
    /// B, BL, CBZ: the target is in the instruction.
    Branch,
    /// BX, BLX, and moves to PC.
    BranchRegister,
    /// LDR to PC, POP and LDM with PC.
    BranchLoad {
        /// Number of words.
        words: u8,
    },
    /// TBB, TBH.
    BranchTable,
    /// VADD, VSUB, VMUL, VCVT.
    FpArithmetic,
    /// VMLA, VFMA and their kin.
    FpMultiplyAdd,
    /// VDIV, VSQRT, which run beside integer instructions.
    FpDivide,
    /// VMOV, VABS, VNEG, VCMP, VMRS.
    FpMove,
    /// VMOV between two core registers and the FPU.
    FpMoveTwo,
    /// VLDR of a single register.
    FpLoad,
    /// VSTR of a single register.
    FpStore,
    /// MSR, MRS, CPS.
    System,
    /// DMB, DSB, ISB, CLREX.
    Barrier,
    /// WFI, WFE.
    Wait,
    /// Not an instruction that compilers emit for this core: SVC, BKPT, UDF.
    Unknown,
}

impl Class {
    /// Returns true if the instruction reads or writes memory.
    #[must_use]
    pub const fn accesses_memory(self) -> bool {
        matches!(
            self,
            Self::Load
                | Self::StoreImmediate
                | Self::StoreRegister
                | Self::Multiple { .. }
                | Self::BranchLoad { .. }
                | Self::BranchTable
                | Self::FpLoad
                | Self::FpStore
        )
    }

    /// Returns true if the FPU computes or moves.
    const fn is_of_fpu(self) -> bool {
        matches!(
            self,
            Self::FpArithmetic
                | Self::FpMultiplyAdd
                | Self::FpDivide
                | Self::FpMove
                | Self::FpMoveTwo
                | Self::FpLoad
                | Self::FpStore
        )
    }
}

/// One decoded instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// What decides its price.
    pub class: Class,
    /// 2 or 4.
    pub bytes: u8,
    /// Core registers that it loads.
    pub loads: u16,
    /// Core registers that make its address.
    pub address: u16,
    /// FPU registers that it writes.
    pub fp_writes: u32,
    /// FPU registers that it needs at its start.
    pub fp_reads: u32,
}

impl Instruction {
    /// Makes an instruction that waits for nobody and for which nobody waits.
    pub(crate) const fn new(class: Class, bytes: u8) -> Self {
        Self {
            class,
            bytes,
            loads: 0,
            address: 0,
            fp_writes: 0,
            fp_reads: 0,
        }
    }

    /// Makes an access to memory.
    pub(crate) const fn access(class: Class, bytes: u8, loads: u16, address: u16) -> Self {
        Self {
            loads,
            address,
            ..Self::new(class, bytes)
        }
    }

    /// Returns true if the FPU has a part in it, so that it waits for a division there.
    #[must_use]
    pub const fn uses_fpu(&self) -> bool {
        self.class.is_of_fpu() || self.fp_reads != 0 || self.fp_writes != 0
    }

    /// Returns true for an access that can only meet the stack: neither flash nor a device.
    #[must_use]
    pub const fn is_on_stack(&self) -> bool {
        self.address == 1 << SP
    }
}

/// Number of the stack pointer.
pub(crate) const SP: u32 = 13;
/// Number of the program counter.
pub(crate) const PC: u32 = 15;

/// Returns the set of one core register, given in the low four bits.
pub(crate) const fn set(register: u32) -> u16 {
    1 << (register & 15)
}
