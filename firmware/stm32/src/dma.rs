//! A way of the DMA between memory and one register of a peripheral: a ring without an end, or a reply of the link's.
//!
//! `dma/streams.rs` is the DMA with streams (F4, H7), `dma/channels.rs` the one with channels behind a DMAMUX (G4). The
//! board's file names the ways: one feeds the DAC, one empties the ADC, and two are a UART's.

#[cfg_attr(feature = "dma-channels", path = "dma/channels.rs")]
#[cfg_attr(feature = "dma-streams", path = "dma/streams.rs")]
mod way;

pub(crate) use way::Controller;

/// A stream or channel of a controller, and what it is for.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    pub(crate) controller: Controller,
    /// The stream's or channel's number in the PAC's arrays, from 0.
    pub(crate) number: usize,
    /// The peripheral's request: a number of the stream's own (F4) or of the DMAMUX.
    pub(crate) request: u8,
    pub(crate) purpose: Purpose,
}

/// What a way carries.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Words from memory to a peripheral, before all other ways; an interrupt when half of the ring or all of it has been
    /// read.
    Feed,
    /// Words from a peripheral to memory; no interrupt.
    Collect,
    /// Bytes from a peripheral to memory; no interrupt.
    #[cfg(feature = "link-uart")]
    Receive,
    /// Bytes from memory to a peripheral, once, behind all other ways; an interrupt when all have been read.
    #[cfg(feature = "link-uart")]
    Send,
}

/// The flags that a way's interrupt found.
pub(crate) struct Flags {
    pub(crate) half: bool,
    pub(crate) whole: bool,
    pub(crate) failed: bool,
}
