//! The renderer: from the mailbox to DAC codes, a block at a time.
//!
//! ```text
//! Orders --> stop? program? dead-man? --> Motion --at(next block)--> 16 ToneBlocks --bank--> samples --> codes
//! ```
//! It may not fail, wait, allocate or take decisions that depend on anything but the program, the orders and the
//! sample index. The dead-man and every ramp to silence live here, so that a link that hangs cannot keep the drive
//! on. The same orders at the same indices give the same codes on every machine.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]
#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::event::Fault;
use slipline_protocol::units::{Gain, SampleIndex};

use crate::bank::{BLOCK, Bank, TONES, ToneBlock, code};
use crate::digest::Digester;
use crate::mailbox::Crossing;
use crate::motion::{Motion, Placement};
use crate::orders::{Orders, Report, Stop};
use crate::ports::{CycleCounter, DacStream, Mute};
use crate::ramp::RampShape;
use crate::timing::{BLOCK_SAMPLES, LIMIT_BLOCKS, SETTLE_BLOCKS, TICK_BLOCKS, Timing};

/// The thermal limit moves by at most this much of full scale a block: from full to nothing in 65 blocks, 21 ms at
/// 400 kS/s, as slow as the amplitude ramps of a glide.
const LIMIT_SLEW: u32 = Gain::FULL.0 / 65;

/// The interrupt's half of the application.
pub struct Renderer {
    timing: Timing,
    shape: RampShape,
    bank: Bank,
    index: SampleIndex,
    motion: Motion,
    /// Where every tone is at the next block's first sample: the motion's value there, kept because it has been
    /// computed for the block before.
    here: [Placement; TONES],
    /// When the ramp to silence that is under way ends.
    stop_ends: Option<SampleIndex>,
    /// Step and amplitude of every tone at the next block's first sample.
    tones: [(u64, u32); TONES],
    /// The share of every amplitude that the thermal limit leaves at the next block's first sample, and where it goes.
    limit: u32,
    limit_goal: u32,
    /// Blocks of mid-scale since the last that was not.
    quiet_blocks: u64,
    muted: bool,
    digester: Digester,
    report: Report,
    begun: bool,
}

impl Renderer {
    /// A renderer whose first sample has index 0.
    #[must_use]
    pub fn new(timing: Timing) -> Self {
        Self::starting_at(timing, 0)
    }

    /// A renderer whose first sample has the index given, rounded down to a block.
    #[must_use]
    pub fn starting_at(timing: Timing, index: SampleIndex) -> Self {
        Self {
            timing,
            shape: RampShape::new(),
            bank: Bank::new(),
            index: index.saturating_sub(index % BLOCK_SAMPLES),
            motion: Motion::silent(),
            here: [Placement::default(); TONES],
            stop_ends: None,
            tones: [(0, 0); TONES],
            limit: Gain::FULL.0,
            limit_goal: Gain::FULL.0,
            quiet_blocks: 0,
            muted: true,
            digester: Digester::default(),
            report: Report { silent: true, ..Report::default() },
            begun: false,
        }
    }

    /// The index of the next block's first sample.
    #[must_use]
    pub const fn index(&self) -> SampleIndex {
        self.index
    }

    /// Whether the amplifier must be muted while the last rendered block sounds.
    #[must_use]
    pub const fn is_muted(&self) -> bool {
        self.muted
    }

    /// Renders, mutes or unmutes, and hands over, for ever.
    pub async fn run<M: RawMutex>(
        &mut self,
        crossing: &Crossing<M>,
        mut dac: impl DacStream,
        mut mute: impl Mute,
        mut cycles: impl CycleCounter,
    ) -> ! {
        let mut codes = [code::MID_SCALE; BLOCK];
        loop {
            let before = cycles.cycles();
            self.render(crossing, &mut codes);
            self.report.max_cycles = self.report.max_cycles.max(cycles.cycles().wrapping_sub(before));
            mute.set_muted(self.muted);
            if dac.write_block(&codes).await.is_err() {
                self.underrun(crossing);
            }
        }
    }

    /// Renders the next block.
    pub fn render<M: RawMutex>(&mut self, crossing: &Crossing<M>, codes: &mut [u16; BLOCK]) {
        if !self.begun {
            self.begun = true;
            crossing.begin_at(self.index);
        }
        let index = self.index;
        let orders = crossing.begin_block(index);
        self.take_limit(orders.limit_per_mille);
        self.obey(&orders, crossing);

        let mut samples = [0; BLOCK];
        let next = index.saturating_add(BLOCK_SAMPLES);
        let (blocks, sum) = self.tone_blocks(next, crossing);
        self.bank.render(&blocks, &mut samples);
        let clipped = code::codes(&samples, codes);

        if let Some(state) = self.digester.take(crossing.digest(), index, codes) {
            crossing.set_digest(state);
        }
        let quiet = blocks.iter().all(|block| block.amplitude == 0 && block.amplitude_end == 0);
        self.switch_mute(quiet, &orders);
        self.report.silent = self.motion.is_silent_from(next);
        self.report.stopping = self.stop_ends.is_some_and(|end| next < end);
        self.report.sum = sum;
        self.report.clips = self.report.clips.saturating_add(clipped);
        if !quiet {
            self.report.energy = self.report.energy.wrapping_add(energy(codes));
        }
        crossing.end_block(self.report);
        self.index = next;
        if (index / BLOCK_SAMPLES).is_multiple_of(TICK_BLOCKS) {
            crossing.signal_tick();
        }
    }

    /// The DAC ran dry: counts it, and if anything sounds ramps to silence and latches the fault.
    ///
    /// While nothing sounds, as during an erase of the flash, a repeated mid-scale is as good as a new one.
    pub fn underrun<M: RawMutex>(&mut self, crossing: &Crossing<M>) {
        self.report.underruns = self.report.underruns.saturating_add(1);
        if self.motion.is_silent_from(self.index) {
            return;
        }
        crossing.disarm_now(Some((Fault::Underrun, self.index)));
        self.fade(Stop::Normal, crossing);
    }

    /// Takes the thermal limit over where it may change: the first one at once, then every so many blocks. While nothing
    /// sounds it is there at once, so that a mirror may begin in any silence.
    #[expect(clippy::cast_possible_truncation, reason = "at most full scale")]
    fn take_limit(&mut self, per_mille: Option<u16>) {
        let may_change = self.report.limit_per_mille.is_none()
            || (self.index / BLOCK_SAMPLES).is_multiple_of(LIMIT_BLOCKS);
        let Some(per_mille) = per_mille.filter(|_| may_change) else { return };
        self.report.limit_per_mille = Some(per_mille);
        // Both factors are small: the product fits.
        self.limit_goal = (u64::from(Gain::FULL.0).saturating_mul(per_mille.min(1000).into()) / 1000) as u32;
        if self.motion.is_silent_from(self.index) {
            self.limit = self.limit_goal;
        }
    }

    /// Follows the orders: first the stops, then the dead-man, then the program.
    fn obey<M: RawMutex>(&mut self, orders: &Orders, crossing: &Crossing<M>) {
        let index = self.index;
        if self.stop_ends.is_some_and(|end| index >= end) {
            self.stop_ends = None;
        }
        if let Some(stop) = orders.stop {
            self.fade(stop, crossing);
        }
        let silent = self.motion.is_silent_from(index);
        let host_lost = orders.armed && index.saturating_sub(orders.fed_at) >= self.timing.dead_man;
        if host_lost {
            // A host that falls silent while nothing sounds has done no harm: the device disarms, without a fault.
            let fault = !silent || orders.program.is_some();
            crossing.disarm_now(fault.then_some((Fault::HostLost, index)));
            self.fade(Stop::HostLost, crossing);
            return;
        }
        if let Some(program) = orders.program {
            // The controller has seen to all this; it is looked at again because this half is the last to look.
            let sounds = program.targets.iter().any(Option::is_some);
            let allowed = !sounds || (orders.armed && index >= orders.ready_at);
            if allowed && self.stop_ends.is_none() {
                let (motion, onsets) = self.motion.follow(&self.here, &program, crossing.slots());
                for ((slot, onset), tone) in onsets.iter().enumerate().zip(&mut self.tones) {
                    if let Some(onset) = onset {
                        self.bank.set_phase(slot, onset.phase);
                        *tone = (onset.step.0, 0);
                    }
                }
                self.motion = motion;
                crossing.moved(motion);
            }
        }
    }

    /// Begins a ramp to silence, unless one is under way that ends sooner.
    fn fade<M: RawMutex>(&mut self, stop: Stop, crossing: &Crossing<M>) {
        let ramp = match stop {
            Stop::Normal => self.timing.stop_ramp,
            Stop::HostLost => self.timing.dead_man_ramp,
            Stop::Emergency => self.timing.emergency_ramp,
        };
        let end = self.index.saturating_add(u64::from(ramp));
        if self.motion.is_silent_from(self.index) || self.stop_ends.is_some_and(|current| current <= end) {
            return;
        }
        self.motion = self.motion.fade(&self.here, self.index, ramp);
        self.stop_ends = Some(end);
        crossing.moved(self.motion);
    }

    /// The bank's orders for this block, and the sum of the amplitudes at its end.
    fn tone_blocks<M: RawMutex>(
        &mut self,
        next: SampleIndex,
        crossing: &Crossing<M>,
    ) -> ([ToneBlock; TONES], u64) {
        let before = self.limit;
        let (lowest, highest) = (before.saturating_sub(LIMIT_SLEW), before.saturating_add(LIMIT_SLEW));
        // Not `clamp`, which would panic if the bounds were crossed: the renderer has no way to panic at all.
        self.limit = self.limit_goal.max(lowest).min(highest).min(Gain::FULL.0);
        let mut blocks = [ToneBlock::default(); TONES];
        let mut sum: u64 = 0;
        if self.index >= self.motion.end() && self.limit == before {
            // Nothing moves any more: the values at this block's start are those at its end.
            for (block, tone) in blocks.iter_mut().zip(&self.tones) {
                *block = ToneBlock::steady(tone.0, tone.1);
                sum = sum.saturating_add(u64::from(tone.1));
            }
            return (blocks, sum);
        }
        let ends = self.motion.placements(next, crossing.slots(), &self.shape);
        for (((block, tone), here), end) in
            blocks.iter_mut().zip(&mut self.tones).zip(&mut self.here).zip(ends)
        {
            let step_end = end.setting.step.0;
            let amplitude_end = end.amplitude().times(Gain(self.limit)).0;
            *block = ToneBlock { step: tone.0, step_end, amplitude: tone.1, amplitude_end };
            *tone = (step_end, amplitude_end);
            *here = end;
            sum = sum.saturating_add(u64::from(amplitude_end));
        }
        (blocks, sum)
    }

    /// Unmutes once mid-scale has flowed after arming; mutes once it has flowed after disarming.
    fn switch_mute(&mut self, quiet: bool, orders: &Orders) {
        self.quiet_blocks = if quiet { self.quiet_blocks.saturating_add(1) } else { 0 };
        if orders.armed {
            self.muted &= self.index < orders.ready_at;
        } else {
            self.muted |= self.quiet_blocks > SETTLE_BLOCKS;
        }
    }
}

/// The sum of the squares of the codes' distances from mid-scale: at most 128 * 2048^2, which 32 bits hold.
fn energy(codes: &[u16; BLOCK]) -> u64 {
    let sum = codes.iter().fold(0, |sum: i32, &code| {
        let distance = i32::from(code).wrapping_sub(const { code::MID_SCALE as i32 });
        sum.wrapping_add(distance.wrapping_mul(distance))
    });
    u64::from(sum.unsigned_abs())
}
