//! The DAC's stream by a DMA with streams (F4, H7): RM0090 chapter 10, and the DMA chapter of RM0433.

use super::Flags;
use crate::board::{DMA_STREAM, route_dma};
use embassy_stm32::pac::DMA1;
use embassy_stm32::pac::dma::{regs, vals};

/// Streams 0 to 3 have their flags in LISR, 4 to 7 in HISR; the PAC indexes both.
const GROUP: usize = DMA_STREAM / 4;
const FLAG: usize = DMA_STREAM % 4;

pub(super) fn start(ring: u32, register: u32, words: u16) {
    stop();
    let stream = DMA1.st(DMA_STREAM);
    stream.par().write_value(register);
    stream.m0ar().write_value(ring);
    stream.ndtr().write_value(regs::Ndtr(u32::from(words)));
    // Direct mode (DMDIS = 0): no FIFO, the stream holds one word ready, so a request is answered in a few cycles.
    stream.fcr().write(|w| w.set_dmdis(vals::Dmdis::ENABLED));
    stream.cr().write(|w| {
        w.set_dir(vals::Dir::MEMORY_TO_PERIPHERAL);
        // Both 32 bit; in direct mode the memory's size is forced to the peripheral's anyway.
        w.set_msize(vals::Size::BITS32);
        w.set_psize(vals::Size::BITS32);
        w.set_minc(true);
        w.set_pinc(false);
        w.set_circ(true);
        w.set_pl(vals::Pl::VERY_HIGH);
        w.set_pfctrl(vals::Pfctrl::DMA);
        w.set_htie(true);
        w.set_tcie(true);
        w.set_teie(true);
        route_dma(w);
    });
    // What was written to the ring is in memory before the stream may read it.
    cortex_m::asm::dmb();
    stream.cr().modify(|w| w.set_en(true));
}

pub(super) fn stop() {
    let stream = DMA1.st(DMA_STREAM);
    stream.cr().modify(|w| w.set_en(false));
    // EN reads 1 until the last access is done, and the other registers are locked until then (RM0090, 10.3.17).
    while stream.cr().read().en() {}
    clear();
}

fn clear() {
    DMA1.ifcr(GROUP).write(|w| {
        w.set_htif(FLAG, true);
        w.set_tcif(FLAG, true);
        w.set_teif(FLAG, true);
        w.set_dmeif(FLAG, true);
        w.set_feif(FLAG, true);
    });
}

pub(super) fn take_flags() -> Flags {
    let seen = DMA1.isr(GROUP).read();
    // Only what was seen: a flag that rises now raises the interrupt again.
    DMA1.ifcr(GROUP).write(|w| {
        w.set_htif(FLAG, seen.htif(FLAG));
        w.set_tcif(FLAG, seen.tcif(FLAG));
        w.set_teif(FLAG, seen.teif(FLAG));
    });
    Flags { half: seen.htif(FLAG), whole: seen.tcif(FLAG), failed: seen.teif(FLAG) }
}

/// Words of the ring that are left until the DMA begins it again.
pub(super) fn left() -> u16 {
    DMA1.st(DMA_STREAM).ndtr().read().ndt()
}
