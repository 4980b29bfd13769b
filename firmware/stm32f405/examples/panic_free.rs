//! Proof by linking: no panic is reachable from a received byte.
//!
//! The panic handler calls a function that does not exist. If one panicking branch is left in the
//! receive path (framing, stuffing, checksum, decoding of every request) or in the encoding of a
//! command, the linker refuses this program:
//!
//! ```text
//! cargo image --example panic_free
//! ```
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod proof {
    //! The receive path, with bytes of any value.

    use core::panic::PanicInfo;
    use core::ptr::{with_exposed_provenance, with_exposed_provenance_mut};

    use cortex_m_rt::entry;
    use fieldline_protocol::frame::{
        MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_reply,
    };
    use fieldline_protocol::message::{Command, Refusal, Reply, Request};
    use stm32f4 as _;

    /// Address of USART1's data register. The compiler cannot know its value.
    const DATA: usize = 0x4001_1004;

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        unsafe extern "Rust" {
            #[link_name = "\nerror: a panicking branch is left in the receive path"]
            safe fn reached() -> !;
        }
        reached()
    }

    #[entry]
    fn main() -> ! {
        static mut RECEIVER: Receiver<MAX_REQUEST_FRAME> = Receiver::new(Side::Device);
        let mut out = [0; MAX_REPLY_FRAME];
        loop {
            // SAFETY: the register exists on the chip. This program is only linked and never run.
            let byte = unsafe { with_exposed_provenance::<u32>(DATA).read_volatile() } as u8;
            let Some(frame) = RECEIVER.push(byte) else {
                continue;
            };
            let reply = match frame.request() {
                Ok(request) => answer(&request),
                Err(_) => Reply::Refused(Refusal::OutOfOrder),
            };
            let length = encode_reply(frame.sequence, &reply, &mut out).unwrap_or(0);
            for byte in out.iter().take(length) {
                // SAFETY: as above.
                unsafe {
                    with_exposed_provenance_mut::<u32>(DATA).write_volatile(u32::from(*byte));
                };
            }
        }
    }

    /// Uses every field, so that the compiler cannot remove any decoding.
    fn answer(request: &Request) -> Reply {
        let mut command = Command::default();
        if let Request::Observation(observation) = request {
            command.velocity = observation.velocity;
            command.heading = observation.pose.yaw ^ observation.pose.x ^ observation.pose.y;
            command.cost.instructions = observation.time_ms;
            for scan in &observation.scans {
                for range in &scan.ranges_mm {
                    command.cost.stack_bytes ^= u32::from(*range);
                }
            }
        }
        if let Request::Hello { nonce, .. } = request {
            command.cost.instructions = *nonce;
        }
        Reply::Command(command)
    }
}

/// Prints the purpose of this program.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program is a proof by linking for thumbv7em-none-eabihf; see its first lines.");
}
