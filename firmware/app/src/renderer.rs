//! The renderer: from the mailbox to DAC codes, a block at a time.
//!
//! ```text
//! Orders --> stop? program? dead-man? --> Motion --at(next block)--> 16 ToneBlocks --bank--> samples --> codes
//! a stop that comes while the block waits to be played: samples --> revised codes
//! ```
//! The whole renderer must take less than half of a block's time. So what a block needs lies in the renderer itself and
//! is changed in place, and the thread side plans new motions: to plan here, or to copy sixteen tones, would cost a good
//! part of that time.
//!
//! It may not fail, wait or allocate. Its decisions depend on the program, the orders and the sample index only; the one
//! exception is a program that waits for the trigger input, whose first index is reported.
//! The dead-man's switch and every ramp to silence are here, so that a link that hangs cannot keep the drive on. The
//! same orders at the same indices give the same codes on every machine.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]
#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

mod revision;

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_dds::bank::{BLOCK, Bank, TONES, ToneBlock, code};
use slipline_dds::lock_in::{Played, PlayedTone};
use slipline_protocol::event::Fault;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{Gain, SampleIndex};

use crate::digest::Digester;
use crate::listening::listener::Listener;
use crate::mailbox::Mailbox;
use crate::mailbox::{Inputs, Orders, Report, Stop};
use crate::motion::Placement;
use crate::motion::outline::Outline;
use crate::ports::{Button, CycleCounter, DacStream, Mute, RendererPorts, SenseStream, Trigger};
use crate::safety::foldback::Foldback;
use crate::timing::{BLOCK_SAMPLES, SETTLE_BLOCKS, TICK_BLOCKS};

/// The thermal limit moves by at most this much of full scale a block: from full to nothing in 65 blocks, 21 ms at
/// 400 kS/s, as slow as the amplitude ramps of a glide.
const LIMIT_SLEW: u32 = Gain::FULL.0 / 65;

/// The interrupt side of the application.
pub struct Renderer {
    timing: Timing,
    bank: Bank,
    index: SampleIndex,
    /// The time of the motion in force; its trajectories are in the mailbox.
    outline: Outline,
    /// Where every tone is at the next block's first sample: the motion's value there, kept because it has been
    /// computed for the block before.
    here: [Placement; TONES],
    /// When the ramp to silence that is under way ends.
    stop_ends: Option<SampleIndex>,
    /// The bank's tones in the last block: their ends are the next block's start.
    tones: [ToneBlock; TONES],
    /// Whether each of them ends as it starts.
    is_steady: bool,
    /// Whether all of them are silent.
    is_quiet: bool,
    samples: [i32; BLOCK],
    /// Clamped samples in this block, and the energy it added.
    clipped: u32,
    energy: u32,
    /// The share of every amplitude that the thermal limit leaves at the next block's first sample, and where it goes.
    limit: u32,
    limit_goal: u32,
    /// The earliest index of its next change.
    limit_due: SampleIndex,
    /// Consecutive blocks of mid-scale so far.
    quiet_blocks: u64,
    muted: bool,
    /// Whether the device is armed and stays muted.
    on_bench: bool,
    /// Whether a program begins with the last rendered block: a drive, or a table that comes into force while armed.
    begins: bool,
    /// Whether a program waits for the trigger input, and whether that has risen before the block to be rendered.
    listens: bool,
    has_risen: bool,
    /// Whether the button was pressed before the last block.
    was_pressed: bool,
    digester: Digester,
    report: Report,
    begun: bool,
}

impl Renderer {
    /// A renderer whose first sample has index 0. Always inlined: a small chip's stack has room for one copy of it.
    #[must_use]
    #[inline(always)]
    pub const fn new(timing: Timing) -> Self {
        Self::starting_at(timing, 0)
    }

    /// A renderer whose first sample has the index given, rounded down to a block. Inlined as [`Renderer::new`].
    #[must_use]
    #[inline(always)]
    pub const fn starting_at(timing: Timing, index: SampleIndex) -> Self {
        let index = index.saturating_sub(index % BLOCK_SAMPLES);
        let limit_due = match index.checked_rem(timing.limit_period) {
            Some(past @ 1..) => index.saturating_sub(past).saturating_add(timing.limit_period),
            _ => index,
        };
        Self {
            timing,
            bank: Bank::new(),
            index,
            outline: Outline::SILENT,
            here: [Placement::NOWHERE; TONES],
            stop_ends: None,
            tones: [ToneBlock::steady(0, 0); TONES],
            is_steady: true,
            is_quiet: true,
            samples: [0; BLOCK],
            clipped: 0,
            energy: 0,
            limit: Gain::FULL.0,
            limit_goal: Gain::FULL.0,
            limit_due,
            quiet_blocks: 0,
            muted: true,
            on_bench: false,
            begins: false,
            listens: false,
            has_risen: false,
            // A button that is held through the start is no press.
            was_pressed: true,
            digester: Digester::new(),
            report: Report::SILENT,
            begun: false,
        }
    }

    /// The index of the next block's first sample.
    #[must_use]
    pub const fn index(&self) -> SampleIndex {
        self.index
    }

    /// How the last block was rendered, for a lock-in on it; silence before the first one.
    #[must_use]
    pub fn played(&self) -> Played {
        let mut tones = self.tones.map(|tone| PlayedTone { phase: tone.block_gain().wrapping_neg(), tone });
        for (played, phase) in tones.iter_mut().zip(self.bank.phases()) {
            played.phase = played.phase.wrapping_add(*phase);
        }
        Played { index: self.index.saturating_sub(BLOCK_SAMPLES), tones }
    }

    /// Whether the amplifier must be muted while the last rendered block sounds.
    #[must_use]
    pub const fn is_muted(&self) -> bool {
        self.muted
    }

    /// Renders, mutes or unmutes, and hands over, for ever.
    ///
    /// A block is rendered when the DAC has room for it and not before: a block kept ready would bear a delay more, but
    /// every command would take effect a block later. It waits in the DAC while the block before it plays; a stop that
    /// comes meanwhile still begins in it, if there is time.
    ///
    /// What the inputs have sampled is listened to last, when the DAC has its block and nothing waits.
    pub async fn run<M: RawMutex>(
        &mut self,
        mailbox: &Mailbox<M>,
        ports: RendererPorts<
            impl DacStream,
            impl Mute,
            impl Trigger,
            impl Button,
            impl CycleCounter,
            impl SenseStream,
        >,
        listener: &mut Listener<'_>,
    ) -> ! {
        let RendererPorts { mut dac, mut mute, mut trigger, mut button, mut cycles, mut sense } = ports;
        let mut codes = [code::MID_SCALE; BLOCK];
        self.begin(mailbox);
        mailbox.set_inputs(Inputs {
            count: sense.inputs(),
            lock_ins: sense.lock_ins(),
            delay_ns: sense.delay_ns(),
            lost_blocks: 0,
        });
        loop {
            if let Either::Second(()) = select(dac.room(), mailbox.stopped()).await {
                if dac.is_revisable()
                    && self.revise(mailbox, &mut codes, |codes| dac.revise_block(codes)).is_err()
                {
                    self.underrun(mailbox);
                }
                continue;
            }
            let before = cycles.cycles();
            self.look_at_button(button.is_pressed(), mailbox);
            let has_listened = self.listens;
            if has_listened {
                self.has_risen = trigger.has_risen();
            }
            self.render_for(mailbox, &mut codes, Some(&mut *listener));
            let rendered = cycles.cycles().wrapping_sub(before);
            self.report.max_cycles = self.report.max_cycles.max(rendered);
            if self.on_bench {
                mute.bench();
            } else {
                mute.set_muted(self.muted);
            }
            if self.listens && !has_listened {
                // A rise of before counts for nothing.
                trigger.has_risen();
                // On the bench a wire may lead from the output to the input.
                self.begins |= self.on_bench;
            }
            if dac.write_block(&codes).await.is_err() {
                self.underrun(mailbox);
                continue;
            }
            if self.begins {
                trigger.rise();
            }
            if (!self.muted || self.on_bench) && mute.stay_on().is_err() {
                self.was_muted(mute.was_stopped(), mailbox);
            }
            let before = cycles.cycles();
            listener.catch_up(&mut sense, mailbox);
            let cost = rendered.wrapping_add(cycles.cycles().wrapping_sub(before));
            self.report.max_cycles = self.report.max_cycles.max(cost);
        }
    }

    /// An emergency stop from the next block on if the button is pressed for the second block, and the device is armed.
    fn look_at_button<M: RawMutex>(&mut self, is_pressed: bool, mailbox: &Mailbox<M>) {
        if is_pressed {
            mailbox.note_press(self.index, !self.was_pressed);
        }
        if is_pressed && self.was_pressed && mailbox.disarm_if_armed((Fault::DeskStop, self.index)) {
            self.fade(Stop::Emergency, mailbox);
        }
        self.was_pressed = is_pressed;
    }

    /// Publishes the first index to the thread side, once.
    fn begin<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        if !self.begun {
            self.begun = true;
            mailbox.begin_at(self.index);
        }
    }

    /// Renders the next block.
    pub fn render<M: RawMutex>(&mut self, mailbox: &Mailbox<M>, codes: &mut [u16; BLOCK]) {
        self.render_for(mailbox, codes, None);
    }

    /// Renders the next block and passes its tones to the listener, if any.
    fn render_for<M: RawMutex>(
        &mut self,
        mailbox: &Mailbox<M>,
        codes: &mut [u16; BLOCK],
        listener: Option<&mut Listener<'_>>,
    ) {
        self.begin(mailbox);
        let index = self.index;
        if self.stop_ends.is_some_and(|end| index >= end) {
            self.stop_ends = None;
        }
        let was_silent = self.outline.is_silent_from(index);
        let (stopping, dead_man) = (self.stop_ends.is_some(), self.timing.dead_man);
        let orders = mailbox.begin_block(index, self.has_risen, |orders| {
            // The controller has checked all this. It is checked again because this is the last place that can.
            let allowed = orders.armed && index >= orders.ready_at;
            let sounds = orders.due.is_some_and(|due| due.sounds);
            !stopping
                && orders.stop.is_none()
                && !is_host_lost(orders, index, dead_man)
                && !is_lease_over(orders, index)
                && (allowed || !sounds)
        });
        self.listens = orders.listens;
        self.take_limit(orders.limit_per_mille, was_silent);
        self.obey(&orders, mailbox);

        let next = index.saturating_add(BLOCK_SAMPLES);
        self.move_tones(next, mailbox);
        if let Some(listener) = listener {
            listener.block_is_rendered(index, self.bank.phases(), &self.tones, mailbox);
        }
        self.bank.render(&self.tones, &mut self.samples);
        let code::Conversion { clipped, energy } = code::codes(&self.samples, codes);
        self.clipped = clipped;

        if let Some(state) = self.digester.take(orders.digest, index, codes) {
            mailbox.set_digest(state);
        }
        self.switch_mute(&orders);
        self.report.silent = self.outline.is_silent_from(next);
        self.report.stopping = self.stop_ends.is_some_and(|end| next < end);
        self.report.muted = self.muted;
        self.report.clips = self.report.clips.saturating_add(self.clipped);
        self.energy = if self.is_quiet { 0 } else { energy };
        self.report.energy = self.report.energy.wrapping_add(self.energy.into());
        mailbox.end_block(self.report);
        self.index = next;
        if (index / BLOCK_SAMPLES).is_multiple_of(TICK_BLOCKS) {
            mailbox.signal_tick();
        }
    }

    /// The last block came too late: counts it; if anything sounds, latches the fault and is silent from the next block
    /// on. A ramp would be wrong: the DAC moves to mid-scale by itself, and plays no block before it arrives.
    ///
    /// While nothing sounds, as during an erase of the flash, mid-scale is as good as the block that was late.
    pub fn underrun<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        self.report.underruns = self.report.underruns.saturating_add(1);
        if !self.outline.is_silent_from(self.index) {
            mailbox.disarm_now(Some((Fault::Underrun, self.index)));
            self.fall_silent(mailbox);
        }
        mailbox.end_block(self.report);
    }

    /// Handles an amplifier that has gone off by itself: the stop input was open, blocks were missing for too long, or the supervisor has
    /// muted it.
    /// An armed device latches the fault even in silence, because the next drive would not sound.
    fn was_muted<M: RawMutex>(&mut self, was_stopped: bool, mailbox: &Mailbox<M>) {
        self.muted = true;
        if was_stopped {
            mailbox.disarm_if_armed((Fault::DeskStop, self.index));
        } else if mailbox.disarm_if_armed((Fault::Underrun, self.index)) {
            self.report.underruns = self.report.underruns.saturating_add(1);
        }
        self.fall_silent(mailbox);
        mailbox.end_block(self.report);
    }

    /// Is silent from the next block on, without a ramp.
    fn fall_silent<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        self.here = [Placement::NOWHERE; TONES];
        mailbox.fade(&self.here, self.index, 0);
        self.outline = mailbox.outline();
        self.stop_ends = None;
        self.tones = [ToneBlock::steady(0, 0); TONES];
        self.is_steady = true;
        self.report.sum = 0;
    }

    /// Takes the thermal limit over: the first one at once, later ones at the start of a fold-back period. While nothing
    /// sounds it is in force without a slew, so that a mirror may begin in any silence.
    #[expect(clippy::cast_possible_truncation, reason = "at most full scale")]
    fn take_limit(&mut self, per_mille: Option<u16>, is_silent: bool) {
        let is_due = self.index >= self.limit_due;
        if is_due {
            self.limit_due = self.limit_due.saturating_add(self.timing.limit_period);
        }
        let may_change = is_due || self.report.foldback.is_none();
        let Some(per_mille) = per_mille.filter(|_| may_change) else { return };
        self.report.foldback = Some(match self.report.foldback {
            Some(foldback) => foldback.next_period(per_mille),
            None => Foldback::first(per_mille),
        });
        // Both factors are small: the product fits.
        self.limit_goal = (u64::from(Gain::FULL.0).saturating_mul(per_mille.min(1000).into()) / 1000) as u32;
        if is_silent {
            self.limit = self.limit_goal;
        }
    }

    /// Follows the orders: first a stop, then the dead-man's switch and the lease, then the program.
    fn obey<M: RawMutex>(&mut self, orders: &Orders, mailbox: &Mailbox<M>) {
        let index = self.index;
        self.begins = false;
        if let Some(stop) = orders.stop {
            self.fade(stop, mailbox);
        } else if !orders.armed && self.stop_ends.is_none() {
            // The last safety net: whatever went wrong, a device that is not armed does not sound.
            self.fade(Stop::Normal, mailbox);
        }
        if is_host_lost(orders, index, self.timing.dead_man) {
            // If the host is lost while nothing sounds, no harm is done: the device disarms without a fault.
            let fault = orders.due.is_some() || !self.outline.is_silent_from(index);
            mailbox.disarm_now(fault.then_some((Fault::HostLost, index)));
            self.fade(Stop::HostLost, mailbox);
        } else if is_lease_over(orders, index) {
            mailbox.disarm_now(None);
            self.fade(Stop::Normal, mailbox);
        } else if orders.begins {
            self.begins = orders.armed;
            self.outline = mailbox.outline();
            mailbox.onsets(|slot, onset| {
                self.bank.set_phase(slot, onset.phase);
                if let Some(tone) = self.tones.get_mut(slot) {
                    (tone.step_end, tone.amplitude_end) = (onset.step.0, 0);
                }
            });
        }
    }

    /// Begins a ramp to silence, unless one is under way that ends sooner.
    fn fade<M: RawMutex>(&mut self, stop: Stop, mailbox: &Mailbox<M>) {
        let ramp = self.ramp(stop);
        if self.may_fade(self.index, ramp) {
            self.fade_from(self.index, ramp, mailbox);
        }
    }

    /// The length of a ramp to silence in samples.
    const fn ramp(&self, stop: Stop) -> u32 {
        match stop {
            Stop::Normal => self.timing.stop_ramp,
            Stop::HostLost => self.timing.dead_man_ramp,
            Stop::Emergency => self.timing.emergency_ramp,
        }
    }

    /// Whether there is something to ramp down, and no ramp under way that ends as soon as one from `start`.
    fn may_fade(&self, start: SampleIndex, ramp: u32) -> bool {
        let end = start.saturating_add(u64::from(ramp));
        !self.outline.is_silent_from(self.index) && self.stop_ends.is_none_or(|current| current > end)
    }

    /// The motion in force becomes a ramp that takes the tones, as they would be at the next block's first sample, to
    /// silence.
    fn fade_from<M: RawMutex>(&mut self, start: SampleIndex, ramp: u32, mailbox: &Mailbox<M>) {
        mailbox.fade(&self.here, start, ramp);
        self.outline = mailbox.outline();
        self.stop_ends = Some(start.saturating_add(u64::from(ramp)));
    }

    /// Computes what the bank renders in this block, up to `next`.
    fn move_tones<M: RawMutex>(&mut self, next: SampleIndex, mailbox: &Mailbox<M>) {
        let before = self.limit;
        let (lowest, highest) = (before.saturating_sub(LIMIT_SLEW), before.saturating_add(LIMIT_SLEW));
        // Not `clamp`, which would panic if the bounds were crossed: the renderer has no way to panic at all.
        self.limit = self.limit_goal.max(lowest).min(highest).min(Gain::FULL.0);
        let mut heard = 0;
        if self.index >= self.outline.end() && self.limit == before {
            // Nothing moves any more: the values at this block's start are those at its end, and so on.
            if self.is_steady {
                return;
            }
            self.is_steady = true;
            for tone in &mut self.tones {
                *tone = ToneBlock::steady(tone.step_end, tone.amplitude_end);
                heard |= tone.amplitude;
            }
        } else {
            self.is_steady = false;
            let limit = Gain(self.limit);
            let mut sum: u64 = 0;
            mailbox.place(&self.outline, next, &mut self.here);
            for (tone, here) in self.tones.iter_mut().zip(&self.here) {
                let amplitude_end = here.amplitude().times(limit).0;
                *tone = ToneBlock {
                    step: tone.step_end,
                    step_end: here.setting.step.0,
                    amplitude: tone.amplitude_end,
                    amplitude_end,
                };
                heard |= tone.amplitude | amplitude_end;
                // Sixteen 32-bit numbers: far from the end of 64 bits.
                sum = sum.wrapping_add(u64::from(amplitude_end));
            }
            self.report.sum = sum;
        }
        self.is_quiet = heard == 0;
    }

    /// Unmutes once mid-scale has flowed after arming, but never on the bench; mutes once it has flowed after disarming.
    fn switch_mute(&mut self, orders: &Orders) {
        self.quiet_blocks = if self.is_quiet { self.quiet_blocks.saturating_add(1) } else { 0 };
        self.on_bench = orders.on_bench;
        if orders.on_bench {
            self.muted = true;
        } else if orders.armed {
            self.muted &= self.index < orders.ready_at;
        } else {
            self.muted |= self.quiet_blocks > SETTLE_BLOCKS;
        }
    }
}

/// Whether an armed device has received nothing from its host for too long.
fn is_host_lost(orders: &Orders, index: SampleIndex, dead_man: u64) -> bool {
    orders.armed && index.saturating_sub(orders.fed_at) >= dead_man
}

/// Whether an armed device has had no drive for as long as its lease.
fn is_lease_over(orders: &Orders, index: SampleIndex) -> bool {
    orders.armed && index >= orders.lease_ends
}
