//! A DMA with channels behind a DMAMUX (G4): RM0440 chapters 12 and 13.

use super::{Flags, Purpose, Way};
use embassy_stm32::pac::DMAMUX1;
use embassy_stm32::pac::bdma::vals;

pub(crate) use embassy_stm32::pac::bdma::Dma as Controller;

impl Way {
    /// Begins with the ring's first word.
    pub(crate) fn start(&self, ring: u32, register: u32, words: u16) {
        self.stop();
        let feeds = self.purpose == Purpose::Feed;
        // DMAMUX channels 0 to 7 feed channels 1 to 8 of DMA1, the only controller that is used (RM0440 13.3.2).
        DMAMUX1.ccr(self.number).write(|w| w.set_dmareq_id(self.request));
        let channel = self.controller.ch(self.number);
        channel.par().write_value(register);
        channel.mar().write_value(ring);
        channel.ndtr().write(|w| w.set_ndt(words));
        channel.cr().write(|w| {
            w.set_dir(if feeds { vals::Dir::FROM_MEMORY } else { vals::Dir::FROM_PERIPHERAL });
            w.set_msize(vals::Size::BITS32);
            w.set_psize(vals::Size::BITS32);
            w.set_minc(true);
            w.set_pinc(false);
            w.set_circ(true);
            w.set_pl(if feeds { vals::Pl::VERY_HIGH } else { vals::Pl::HIGH });
            w.set_htie(feeds);
            w.set_tcie(feeds);
            w.set_teie(feeds);
        });
        // What was written to the ring is in memory before the channel may read it.
        cortex_m::asm::dmb();
        channel.cr().modify(|w| w.set_en(true));
    }

    pub(crate) fn stop(&self) {
        self.controller.ch(self.number).cr().modify(|w| w.set_en(false));
        self.controller.ifcr().write(|w| w.set_gif(self.number, true));
    }

    pub(crate) fn take_flags(&self) -> Flags {
        let seen = self.controller.isr().read();
        // Only what was seen: a flag that rises now raises the interrupt again.
        self.controller.ifcr().write(|w| {
            w.set_htif(self.number, seen.htif(self.number));
            w.set_tcif(self.number, seen.tcif(self.number));
            w.set_teif(self.number, seen.teif(self.number));
        });
        Flags { half: seen.htif(self.number), whole: seen.tcif(self.number), failed: seen.teif(self.number) }
    }

    /// Words of the ring that are left until the DMA begins it again.
    pub(crate) fn left(&self) -> u16 {
        self.controller.ch(self.number).ndtr().read().ndt()
    }
}
