//! A DMA with streams (F4, H7): RM0090 chapter 10, and the DMA chapter of RM0433.

#[cfg(feature = "link-uart")]
compile_error!("these ways carry words: the bytes of a UART take a DMA with channels (`dma-channels`)");

use super::{Flags, Purpose, Way};
use crate::board::route_dma;
use embassy_stm32::pac::dma::{regs, vals};

pub(crate) use embassy_stm32::pac::dma::Dma as Controller;

/// Reads of EN before the wait is given up: the last access is over after some tens of cycles.
const STOP_TRIES: u32 = 1000;

impl Way {
    /// Streams 0 to 3 have their flags in LISR, 4 to 7 in HISR; the PAC indexes both.
    const fn flags(&self) -> (usize, usize) {
        (self.number / 4, self.number % 4)
    }

    /// Begins with the ring's first word.
    pub(crate) fn start(&self, ring: u32, register: u32, words: u16) {
        self.stop();
        let stream = self.controller.st(self.number);
        let feeds = self.purpose == Purpose::Feed;
        stream.par().write_value(register);
        stream.m0ar().write_value(ring);
        stream.ndtr().write_value(regs::Ndtr(u32::from(words)));
        // Direct mode (DMDIS = 0): no FIFO. A stream that reads memory holds one word ready, so a request is answered in a
        // few cycles.
        stream.fcr().write(|w| w.set_dmdis(vals::Dmdis::ENABLED));
        stream.cr().write(|w| {
            w.set_dir(if feeds { vals::Dir::MEMORY_TO_PERIPHERAL } else { vals::Dir::PERIPHERAL_TO_MEMORY });
            // Both 32 bit; in direct mode the memory's size is forced to the peripheral's anyway.
            w.set_msize(vals::Size::BITS32);
            w.set_psize(vals::Size::BITS32);
            w.set_minc(true);
            w.set_pinc(false);
            w.set_circ(true);
            w.set_pl(if feeds { vals::Pl::VERY_HIGH } else { vals::Pl::HIGH });
            w.set_pfctrl(vals::Pfctrl::DMA);
            w.set_htie(feeds);
            w.set_tcie(feeds);
            w.set_teie(feeds);
            route_dma(self, w);
        });
        // What was written to the ring is in memory before the stream may read it.
        cortex_m::asm::dmb();
        stream.cr().modify(|w| w.set_en(true));
    }

    pub(crate) fn stop(&self) {
        let stream = self.controller.st(self.number);
        stream.cr().modify(|w| w.set_en(false));
        // EN reads 1 until the last access is done, and the other registers are locked until then (RM0090, 10.3.17).
        for _ in 0..STOP_TRIES {
            if !stream.cr().read().en() {
                break;
            }
        }
        let (group, flag) = self.flags();
        self.controller.ifcr(group).write(|w| {
            w.set_htif(flag, true);
            w.set_tcif(flag, true);
            w.set_teif(flag, true);
            w.set_dmeif(flag, true);
            w.set_feif(flag, true);
        });
    }

    pub(crate) fn take_flags(&self) -> Flags {
        let (group, flag) = self.flags();
        let seen = self.controller.isr(group).read();
        // Only what was seen: a flag that rises now raises the interrupt again.
        self.controller.ifcr(group).write(|w| {
            w.set_htif(flag, seen.htif(flag));
            w.set_tcif(flag, seen.tcif(flag));
            w.set_teif(flag, seen.teif(flag));
        });
        Flags { half: seen.htif(flag), whole: seen.tcif(flag), failed: seen.teif(flag) }
    }

    /// Words of the ring that are left until the DMA begins it again.
    pub(crate) fn left(&self) -> u16 {
        self.controller.st(self.number).ndtr().read().ndt()
    }
}
