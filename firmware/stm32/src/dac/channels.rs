//! The DAC's stream by a DMA with channels behind a DMAMUX (G4): RM0440 chapters 12 and 13.

use super::Flags;
use crate::board::{DMA_REQUEST, DMA_STREAM};
use embassy_stm32::pac::bdma::vals;
use embassy_stm32::pac::{DMA1, DMAMUX1};

pub(super) fn start(ring: u32, register: u32, words: u16) {
    stop();
    // DMAMUX channels 0 to 7 feed channels 1 to 8 of DMA1 (RM0440 13.3.2).
    DMAMUX1.ccr(DMA_STREAM).write(|w| w.set_dmareq_id(DMA_REQUEST));
    let channel = DMA1.ch(DMA_STREAM);
    channel.par().write_value(register);
    channel.mar().write_value(ring);
    channel.ndtr().write(|w| w.set_ndt(words));
    channel.cr().write(|w| {
        w.set_dir(vals::Dir::FROM_MEMORY);
        w.set_msize(vals::Size::BITS32);
        w.set_psize(vals::Size::BITS32);
        w.set_minc(true);
        w.set_pinc(false);
        w.set_circ(true);
        w.set_pl(vals::Pl::VERY_HIGH);
        w.set_htie(true);
        w.set_tcie(true);
        w.set_teie(true);
    });
    // What was written to the ring is in memory before the channel may read it.
    cortex_m::asm::dmb();
    channel.cr().modify(|w| w.set_en(true));
}

pub(super) fn stop() {
    DMA1.ch(DMA_STREAM).cr().modify(|w| w.set_en(false));
    DMA1.ifcr().write(|w| w.set_gif(DMA_STREAM, true));
}

pub(super) fn take_flags() -> Flags {
    let seen = DMA1.isr().read();
    // Only what was seen: a flag that rises now raises the interrupt again.
    DMA1.ifcr().write(|w| {
        w.set_htif(DMA_STREAM, seen.htif(DMA_STREAM));
        w.set_tcif(DMA_STREAM, seen.tcif(DMA_STREAM));
        w.set_teif(DMA_STREAM, seen.teif(DMA_STREAM));
    });
    Flags { half: seen.htif(DMA_STREAM), whole: seen.tcif(DMA_STREAM), failed: seen.teif(DMA_STREAM) }
}

/// Words of the ring that are left until the DMA begins it again.
pub(super) fn left() -> u16 {
    DMA1.ch(DMA_STREAM).ndtr().read().ndt()
}
