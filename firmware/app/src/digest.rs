//! A CRC-32 of the DAC codes of a window, computed only while the window is open.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use slipline_protocol::command::DigestWindow;
use slipline_protocol::frame::CRC;
use slipline_protocol::units::SampleIndex;

use crate::bank::BLOCK;

/// One instance, so that its lookup table exists once and a running digest can refer to it.
static ENGINE: crc::Crc<u32> = CRC;

/// How a digest stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DigestState {
    /// None has been asked for.
    None,
    /// The window lies ahead or is open.
    Waiting(DigestWindow),
    /// The window is over.
    Done(DigestWindow, u32),
}

/// The renderer's part: takes every block, adds up those of the window.
#[derive(Default)]
pub(crate) struct Digester {
    running: Option<(DigestWindow, crc::Digest<'static, u32>)>,
}

impl Digester {
    /// Takes the block at `index` and returns the new state, if it has changed.
    pub(crate) fn take(
        &mut self,
        state: DigestState,
        index: SampleIndex,
        codes: &[u16; BLOCK],
    ) -> Option<DigestState> {
        let DigestState::Waiting(window) = state else {
            self.running = None;
            return None;
        };
        if self.running.as_ref().is_none_or(|(running, _)| *running != window) {
            self.running = Some((window, ENGINE.digest()));
        }
        let (_, digest) = self.running.as_mut()?;
        let end = window.from.saturating_add(u64::from(window.count));
        // The window's part of this block, as offsets of at most a block.
        let offset = |at: SampleIndex| usize::try_from(at.saturating_sub(index)).unwrap_or(BLOCK).min(BLOCK);
        let mut bytes = [[0; 2]; BLOCK];
        for (bytes, code) in bytes.iter_mut().zip(codes) {
            *bytes = code.to_le_bytes();
        }
        digest.update(bytes.get(offset(window.from)..offset(end)).unwrap_or_default().as_flattened());
        if end > index.saturating_add(BLOCK as u64) {
            return None;
        }
        let (_, digest) = self.running.take()?;
        Some(DigestState::Done(window, digest.finalize()))
    }
}
