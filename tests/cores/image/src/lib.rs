//! What a program needs to run on an emulated core and on the host alike.
//!
//! ```text
//! on_core.rs        arguments, printing and the end, through the emulator's semihosting
//! on_host.rs        the same on the host
//! bin/parity.rs     prints the hashes of everything computed
//! bin/cost.rs       one piece of work over and over, to be counted
//! bin/size_*.rs     parts linked alone, to be weighed
//! ```
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
#[path = "on_core.rs"]
pub mod platform;
#[cfg(not(target_os = "none"))]
#[path = "on_host.rs"]
pub mod platform;

/// Makes `$run`, a function without arguments, the program.
#[macro_export]
macro_rules! program {
    ($run:path) => {
        #[cfg(not(target_os = "none"))]
        fn main() {
            $run();
        }

        #[cfg(all(target_os = "none", target_arch = "arm"))]
        #[cortex_m_rt::entry]
        fn main() -> ! {
            $run();
            $crate::platform::end()
        }

        #[cfg(all(target_os = "none", target_arch = "riscv32"))]
        #[riscv_rt::entry]
        fn main() -> ! {
            $run();
            $crate::platform::end()
        }
    };
}
