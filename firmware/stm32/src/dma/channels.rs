//! A DMA with channels behind a DMAMUX (G4): RM0440 chapters 12 and 13.

use super::{Flags, Purpose, Way};
use embassy_stm32::pac::DMAMUX1;
use embassy_stm32::pac::bdma::vals;

pub(crate) use embassy_stm32::pac::bdma::Dma as Controller;

impl Way {
    /// Begins with the ring's first word, or with a reply's first byte.
    pub(crate) fn start(&self, ring: u32, register: u32, words: u16) {
        self.stop();
        let (direction, size, priority) = match self.purpose {
            Purpose::Feed => (vals::Dir::FROM_MEMORY, vals::Size::BITS32, vals::Pl::VERY_HIGH),
            Purpose::Collect => (vals::Dir::FROM_PERIPHERAL, vals::Size::BITS32, vals::Pl::HIGH),
            #[cfg(feature = "link-uart")]
            Purpose::Receive => (vals::Dir::FROM_PERIPHERAL, vals::Size::BITS8, vals::Pl::MEDIUM),
            #[cfg(feature = "link-uart")]
            Purpose::Send => (vals::Dir::FROM_MEMORY, vals::Size::BITS8, vals::Pl::LOW),
        };
        // A way from memory raises its interrupt; only a ring that feeds one at its half, too.
        let feeds = self.purpose == Purpose::Feed;
        let reads_memory = direction == vals::Dir::FROM_MEMORY;
        // DMAMUX channels 0 to 7 feed channels 1 to 8 of DMA1, the only controller that is used (RM0440 13.3.2).
        DMAMUX1.ccr(self.number).write(|w| w.set_dmareq_id(self.request));
        let channel = self.controller.ch(self.number);
        channel.par().write_value(register);
        channel.mar().write_value(ring);
        channel.ndtr().write(|w| w.set_ndt(words));
        channel.cr().write(|w| {
            w.set_dir(direction);
            w.set_msize(size);
            w.set_psize(size);
            w.set_minc(true);
            w.set_pinc(false);
            w.set_circ(feeds || !reads_memory);
            w.set_pl(priority);
            w.set_htie(feeds);
            w.set_tcie(reads_memory);
            w.set_teie(reads_memory);
        });
        // What was written there is in memory before the channel may read it.
        cortex_m::asm::dmb();
        channel.cr().modify(|w| w.set_en(true));
    }

    pub(crate) fn stop(&self) {
        self.controller.ch(self.number).cr().modify(|w| w.set_en(false));
        self.controller.ifcr().write(|w| w.set_gif(self.number, true));
    }

    pub(crate) fn take_flags(&self) -> Flags {
        let seen = self.flags();
        // Only what was seen: a flag that rises now raises the interrupt again.
        self.controller.ifcr().write(|w| {
            w.set_htif(self.number, seen.half);
            w.set_tcif(self.number, seen.whole);
            w.set_teif(self.number, seen.failed);
        });
        seen
    }

    /// The flags, which stay.
    pub(crate) fn flags(&self) -> Flags {
        let seen = self.controller.isr().read();
        Flags { half: seen.htif(self.number), whole: seen.tcif(self.number), failed: seen.teif(self.number) }
    }

    /// What is left of the ring until the DMA begins it again, in its words or bytes.
    pub(crate) fn left(&self) -> u16 {
        self.controller.ch(self.number).ndtr().read().ndt()
    }
}
