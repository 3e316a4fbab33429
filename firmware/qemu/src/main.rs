//! (being written)
#![cfg_attr(target_arch = "arm", no_std, no_main)]

#[cfg(target_arch = "arm")]
mod device {
    use cortex_m_rt::entry;

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo) -> ! {
        loop {
            cortex_m::asm::nop();
        }
    }

    #[entry]
    fn main() -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }
}

#[cfg(not(target_arch = "arm"))]
fn main() {
    println!("build me with --target thumbv7em-none-eabihf and run me in qemu-system-arm -M mps2-an386");
}
