//! The chip: clocks, pins, timers, watchdog.
//!
//! | resource | use |
//! | --- | --- |
//! | PA9, PA10 | USART1, transmit and receive |
//! | PB0 | emergency stop: a normally closed contact to ground; pulled up, high is pressed |
//! | PC12 | status LED, lit when low (as on the Olimex STM32-H405) |
//! | TIM2 | runs freely: instructions in QEMU, half-cycles (84 MHz) on silicon |
//! | ITM | marks of a step's stages, in QEMU only, where a plugin sees them |
//! | `SysTick` | milliseconds, on silicon only: in QEMU time stands still while the host computes |
//! | IWDG | one second, on silicon only: QEMU has none |
//!
//! QEMU models no clock tree: there HSIRDY reads 0. On silicon it is 1 before the first
//! instruction. The program uses this to detect QEMU.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::scb::Exception;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{ITM, NVIC, SCB};
use cortex_m_rt::exception;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use fieldline_device::port;
use fieldline_device::{Mark, Meter};
use stm32f4::stm32f405::{FLASH, GPIOB, GPIOC, IWDG, Interrupt, Peripherals, RCC, TIM2};

use super::uart::Uart;
use super::{crash, logger};

/// Frequency of the internal oscillator, which the chip uses without a crystal.
const HSI_HZ: u32 = 16_000_000;
/// Frequency from the 8 MHz crystal through the PLL.
const PLL_HZ: u32 = 168_000_000;
/// Number of polls before an oscillator counts as failed: some milliseconds.
const MAX_CLOCK_POLLS: u32 = 100_000;
/// Period of `SysTick`, milliseconds.
const TICK_MS: u32 = 10;

/// Time since the boot, milliseconds; 0 in the emulator.
static MILLISECONDS: AtomicU32 = AtomicU32::new(0);

/// The peripherals that the main loop uses.
pub(crate) struct Board {
    timer: TIM2,
    trace: ITM,
    watchdog: Option<IWDG>,
    emulated: bool,
    by_watchdog: bool,
    /// Number of boots, which selects the crash.
    #[cfg(feature = "crash-test")]
    pub(crate) boots: u32,
}

/// The emergency stop input.
pub(crate) struct EmergencyStop(GPIOB);

/// The status LED.
pub(crate) struct Led(GPIOC);

impl Board {
    /// Sets up the chip. The entry point calls this once, before everything else.
    pub(crate) fn take() -> (Self, Uart, EmergencyStop, Led) {
        // SAFETY: the entry point calls this once and nothing else owns peripherals. Interrupts use
        // USART1 only to read its data register, and do not use SysTick.
        let (core, chip) = unsafe { (cortex_m::Peripherals::steal(), Peripherals::steal()) };
        let (mut scb, mut systick) = (core.SCB, core.SYST);
        scb.enable(Exception::BusFault);

        let emulated = chip.RCC.cr().read().hsirdy().bit_is_clear();
        let hz = if emulated {
            HSI_HZ
        } else {
            start_clocks(&chip.RCC, &chip.FLASH)
        };
        let by_watchdog = chip.RCC.csr().read().wdgrstf().bit_is_set();
        chip.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        enable_peripherals(&chip.RCC);
        let (emergency_stop, led) = set_up_pins(chip.GPIOB, chip.GPIOC);

        chip.GPIOA
            .moder()
            .modify(|_, w| w.moder9().alternate().moder10().alternate());
        // Pulled up, so that an unplugged line is an idle line.
        chip.GPIOA.pupdr().modify(|_, w| w.pupdr10().pull_up());
        chip.GPIOA
            .afrh()
            .modify(|_, w| w.afrh9().af7().afrh10().af7());
        // APB2 runs at half the core's clock with the PLL, and at the full clock without it.
        let bus_hz = if hz == PLL_HZ { hz / 2 } else { hz };
        let uart = Uart::new(chip.USART1, bus_hz);

        chip.TIM2.arr().write(|w| w.set(u32::MAX));
        chip.TIM2.cr1().write(|w| w.cen().set_bit());
        let mut watchdog = None;
        if !emulated {
            systick.set_clock_source(SystClkSource::Core);
            systick.set_reload(hz / 1000 * TICK_MS - 1);
            systick.clear_current();
            systick.enable_counter();
            systick.enable_interrupt();
            // A debugger that halts the core halts the watchdog too.
            chip.DBGMCU
                .apb1_fz()
                .modify(|_, w| w.dbg_iwdg_stop().set_bit());
            watchdog = Some(start_watchdog(chip.IWDG));
        }
        let board = Self {
            timer: chip.TIM2,
            trace: core.ITM,
            watchdog,
            emulated,
            by_watchdog,
            #[cfg(feature = "crash-test")]
            boots: 0,
        };
        (board, uart, emergency_stop, led)
    }

    /// Returns true if the watchdog caused the last reset.
    pub(crate) const fn reset_by_watchdog(&self) -> bool {
        self.by_watchdog
    }

    /// Restarts the watchdog. The main loop calls this in every turn.
    pub(crate) fn feed_watchdog(&self) {
        if let Some(watchdog) = &self.watchdog {
            watchdog.kr().write(|w| w.key().feed());
        }
    }

    /// Sleeps until an interrupt, unless there is work. An interrupt between the check and the
    /// sleep still wakes the core, because it stays pending.
    pub(crate) fn sleep_unless(&self, work: impl FnOnce() -> bool) {
        cortex_m::interrupt::free(|_| {
            if !work() {
                cortex_m::asm::wfi();
            }
        });
    }
}

/// Starts the PLL on the 8 MHz crystal: 168 MHz. If that fails, the core stays on the internal
/// oscillator: 16 MHz. Returns the core's clock in hertz.
fn start_clocks(rcc: &RCC, flash: &FLASH) -> u32 {
    let becomes_ready = |ready: &dyn Fn() -> bool| (0..MAX_CLOCK_POLLS).any(|_| ready());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if !becomes_ready(&|| rcc.cr().read().hserdy().bit_is_set()) {
        return HSI_HZ;
    }
    // 8 MHz / 8 × 336 / 2 = 168 MHz, and / 7 = 48 MHz for peripherals that need it.
    rcc.pllcfgr().write(|w| {
        // SAFETY: the factors keep the PLL within its limits: input 1 MHz, oscillator 336 MHz
        // (RM0090, 7.3.2).
        unsafe { w.pllm().bits(8).plln().bits(336).pllq().bits(7) };
        w.pllsrc().hse().pllp().div2()
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    if !becomes_ready(&|| rcc.cr().read().pllrdy().bit_is_set()) {
        return HSI_HZ;
    }
    // Five wait states at 168 MHz and 3.3 V (RM0090, table 10). Prefetch and caches hide them.
    flash.acr().write(|w| {
        w.latency().ws5();
        w.prften().set_bit().icen().set_bit().dcen().set_bit()
    });
    rcc.cfgr()
        .modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    if becomes_ready(&|| rcc.cfgr().read().sws().is_pll()) {
        PLL_HZ
    } else {
        HSI_HZ
    }
}

fn enable_peripherals(rcc: &RCC) {
    rcc.ahb1enr().modify(|_, w| {
        w.gpioaen()
            .set_bit()
            .gpioben()
            .set_bit()
            .gpiocen()
            .set_bit()
    });
    rcc.apb2enr().modify(|_, w| w.usart1en().set_bit());
    rcc.apb1enr().modify(|_, w| w.tim2en().set_bit());
}

fn set_up_pins(gpiob: GPIOB, gpioc: GPIOC) -> (EmergencyStop, Led) {
    gpiob.moder().modify(|_, w| w.moder0().input());
    gpiob.pupdr().modify(|_, w| w.pupdr0().pull_up());
    gpioc.moder().modify(|_, w| w.moder12().output());
    (EmergencyStop(gpiob), Led(gpioc))
}

/// Starts the watchdog with one second of its 32 kHz oscillator. The oscillator has 17 to 47 kHz,
/// so the time is 0.7 to 1.9 s.
fn start_watchdog(watchdog: IWDG) -> IWDG {
    watchdog.kr().write(|w| w.key().start());
    watchdog.kr().write(|w| w.key().unlock());
    watchdog.pr().write(|w| w.pr().divide_by32());
    watchdog.rlr().write(|w| w.rl().set(1000));
    watchdog.kr().write(|w| w.key().feed());
    watchdog
}

#[exception]
fn SysTick() {
    let now = MILLISECONDS.load(Ordering::Relaxed);
    MILLISECONDS.store(now.wrapping_add(TICK_MS), Ordering::Relaxed);
}

impl Meter for Board {
    fn start(&mut self) {
        if self.emulated {
            // The interrupt of a received byte would add to the count. In QEMU the byte waits; on
            // silicon it would be lost.
            NVIC::mask(Interrupt::USART1);
        }
        #[cfg(feature = "crash-test")]
        crash::crash_on_third_step(self.boots);
    }

    fn stop(&mut self) {
        if self.emulated {
            super::uart::listen();
        }
    }

    fn mark(&mut self, mark: Mark) -> u32 {
        if self.emulated {
            // The emulator ignores the store; a plugin sees its address and counts cycles by stage.
            self.trace.stim[mark.number()].write_u8(0);
        }
        self.timer.cnt().read().bits()
    }

    fn stack_bytes(&self) -> u32 {
        crash::deepest_stack_bytes()
    }
}

impl port::Board for Board {
    /// Returns the time since the boot; always 0 in the emulator.
    fn now_ms(&mut self) -> u32 {
        MILLISECONDS.load(Ordering::Relaxed)
    }

    fn take_log(&mut self, out: &mut [u8]) -> usize {
        logger::take(out)
    }
}

impl ErrorType for EmergencyStop {
    type Error = core::convert::Infallible;
}

impl InputPin for EmergencyStop {
    fn is_high(&mut self) -> Result<bool, Self::Error> {
        Ok(self.0.idr().read().idr0().is_high())
    }

    fn is_low(&mut self) -> Result<bool, Self::Error> {
        self.is_high().map(|high| !high)
    }
}

impl ErrorType for Led {
    type Error = core::convert::Infallible;
}

impl OutputPin for Led {
    /// Lights the LED, which is connected between the supply and the pin.
    fn set_high(&mut self) -> Result<(), Self::Error> {
        self.0.bsrr().write(|w| w.br12().reset());
        Ok(())
    }

    fn set_low(&mut self) -> Result<(), Self::Error> {
        self.0.bsrr().write(|w| w.bs12().set_());
        Ok(())
    }
}

/// Resets the chip.
pub(crate) fn reset() -> ! {
    SCB::sys_reset()
}
