//! Planning: makes the motion of a drive or of a table swap, or refuses it.
//!
//! A motion depends only on the arguments of [`Planner::drive`] and [`Planner::swap`] and on the table slots. The
//! controller plans before it accepts a command. The host's mirror plans with the index in the device's answer and gets
//! the same motion.

use slipline_dds::bank::{BLOCK, MAX_STEP_CHANGE};
use slipline_protocol::command::{Chord, Comb, Drive};
use slipline_protocol::limits::{MAX_TONES, MIN_MASTER_CDB};
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{CentiDecibel, Gain, SampleIndex};

use crate::motion::{Motion, Placement};
use crate::planning::chord::ChordTones;
use crate::planning::headroom;
use crate::planning::level::master_gain;
use crate::planning::program::{Program, Target};
use crate::range::in_range;
use crate::slots::{Extremes, TableRef, TableSlots};

/// Inputs of the planner: tables, limits of time, and the check for a stop.
pub struct Planner<'a> {
    /// The tables.
    pub slots: &'a TableSlots,
    /// The limits of times.
    pub timing: &'a Timing,
    /// Whether a stop has come. Called before each tone and between all other parts of the work, since planning may take as long as a
    /// block, and a device that measures leaves the thread a fifth of it.
    pub is_stopped: &'a mut dyn FnMut() -> bool,
}

impl Planner<'_> {
    /// Makes the motion of a drive that begins at `at`, where the output moves as `motion` says.
    ///
    /// The glide becomes longer than asked where the frequency would change faster than the bank's accuracy allows
    /// ([`MAX_STEP_CHANGE`] per block).
    ///
    /// # Errors
    /// [`Refusal::NoTable`], [`Refusal::OutOfRange`] for slot, master level or glide, [`Refusal::SlotTwice`],
    /// [`Refusal::Headroom`] if the worst-case sum exceeds full scale anywhere on the way, [`Busy::DriveActive`] if a stop
    /// has come.
    pub fn drive(
        &mut self,
        drive: &Drive,
        at: SampleIndex,
        table: TableRef,
        motion: &Motion,
    ) -> Result<Motion, Refusal> {
        self.refuse_if_stopped()?;
        let targets = self.targets(drive, table)?;
        self.complete(Program { at, glide: drive.glide, table, targets }, motion)
    }

    /// Makes the motion of a table swap: every tone goes on to its place and level, in the time that it still has, and
    /// glides to the new table's values.
    ///
    /// # Errors
    /// [`Refusal::Headroom`] if the sum would exceed full scale by the new table, [`Busy::DriveActive`] if a stop has come.
    pub fn swap(&mut self, at: SampleIndex, table: TableRef, motion: &Motion) -> Result<Motion, Refusal> {
        let left = u32::try_from(motion.end().saturating_sub(at)).unwrap_or(u32::MAX);
        let glide = self.timing.table_glide.max(left);
        self.complete(Program { at, glide, table, targets: motion.goals() }, motion)
    }

    /// Makes the motion that brings tones that sound to other levels, by the rules of a drive: their places, steps and gains
    /// stay as they are, and so do the tones for which there is no level. Where no tone sounds nothing changes.
    ///
    /// # Errors
    /// [`Refusal::OutOfRange`] for the glide, [`Refusal::Headroom`], and [`Busy::DriveActive`] as [`Planner::drive`].
    pub fn levels(
        &mut self,
        levels: &[Option<Gain>; MAX_TONES],
        at: SampleIndex,
        glide: u32,
        motion: &Motion,
    ) -> Result<Motion, Refusal> {
        self.check_glide(glide)?;
        let mut targets = motion.goals_as_set();
        for (target, level) in targets.iter_mut().zip(levels) {
            if let (Some(target), Some(level)) = (target, level) {
                target.level = *level;
            }
        }
        self.complete(Program { at, glide, table: motion.table(), targets }, motion)
    }

    /// Checks a chord's fields and places its tones by a table.
    ///
    /// # Errors
    /// [`Refusal::NoTable`], [`Refusal::OutOfRange`] for the master level, the glide, and as [`ChordTones::of`].
    pub fn place_chord(&self, chord: &Chord, table: TableRef, tones: &mut ChordTones) -> Result<(), Refusal> {
        self.check_ranges(table, chord.master, chord.glide)?;
        tones.set(chord, table.knots, |index| self.slots.knot(table.slot, index))
    }

    /// Checks a comb's fields and the sum of its amplitudes, and places its tones by a table.
    ///
    /// # Errors
    /// [`Refusal::NoTable`], [`Refusal::OutOfRange`] for the master level, the glide, the period, the number of tones and a
    /// multiple, [`Refusal::Headroom`].
    pub fn place_comb(&self, comb: &Comb, table: TableRef, tones: &mut ChordTones) -> Result<(), Refusal> {
        self.check_ranges(table, comb.master, comb.glide)?;
        tones.set_comb(comb, table.knots, |index| self.slots.knot(table.slot, index))?;
        // The tones must fit for any phases.
        Refusal::check_sum(tones.sum(), Gain::FULL)
    }

    /// Makes the motion of a chord or a comb that rises from silence at `at`. Whether a chord's sum fits is not checked here:
    /// that is [`Proof::check`](crate::planning::chord::Proof::check)'s work.
    ///
    /// # Errors
    /// [`Busy::DriveActive`] if anything sounds at `at`, or if a stop has come.
    pub fn chord(
        &mut self,
        tones: &ChordTones,
        at: SampleIndex,
        glide: u32,
        table: TableRef,
        motion: &Motion,
    ) -> Result<Motion, Refusal> {
        self.refuse_if_stopped()?;
        if !motion.is_silent_from(at) {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        Ok(Motion::rising(at, glide, table, tones.targets(), self.slots))
    }

    /// Checks a drive's fields; returns where each tone shall go.
    fn targets(&self, drive: &Drive, table: TableRef) -> Result<[Option<Target>; MAX_TONES], Refusal> {
        self.check_ranges(table, drive.master, drive.glide)?;
        let master = master_gain(drive.master);
        let mut targets = [None; MAX_TONES];
        for tone in &drive.tones {
            let refused =
                || Refusal::out_of_range(Field::ToneSlot, 0, MAX_TONES as i64 - 1, tone.slot.into());
            let target = targets.get_mut(usize::from(tone.slot)).ok_or_else(refused)?;
            if target.is_some() {
                return Err(Refusal::SlotTwice { slot: tone.slot });
            }
            *target = Some(Target {
                position: tone.position.fine(),
                level: master.scaled(tone.level),
                phase: u64::from(tone.phase.0) << 48,
                setting: None,
            });
        }
        Ok(targets)
    }

    fn check_ranges(&self, table: TableRef, master: CentiDecibel, glide: u32) -> Result<(), Refusal> {
        if table.knots == 0 {
            return Err(Refusal::NoTable);
        }
        Refusal::check(Field::MasterLevel, MIN_MASTER_CDB.into(), 0, master.0.into())?;
        self.check_glide(glide)
    }

    fn check_glide(&self, glide: u32) -> Result<(), Refusal> {
        let timing = self.timing;
        in_range(Field::Glide, timing.min_glide.into(), timing.max_glide.into(), glide.into())
    }

    /// Checks the headroom, stretches the glide, and goes on from where the tones are.
    fn complete(&mut self, mut program: Program, motion: &Motion) -> Result<Motion, Refusal> {
        let slots = self.slots;
        self.refuse_if_stopped()?;
        let placements = motion.at(program.at, slots);
        let mut ways = [Extremes::default(); MAX_TONES];
        let mut needed = 0;
        let tones = ways.iter_mut().zip(&placements).zip(&program.targets);
        for ((way, placement), target) in tones {
            self.refuse_if_stopped()?;
            // A tone that starts from silence starts at its target, and one that keeps its setting stays where it is.
            if let Some(target) = target.filter(|target| !placement.is_silent() && target.setting.is_none()) {
                *way = slots.extremes(program.table, placement.position, target.position);
                needed = needed.max(shortest_glide(&program, placement, &target, way.steepest, slots));
            }
        }
        headroom::check(&program, &placements, &ways, slots)?;
        self.refuse_if_stopped()?;
        program.glide = program.glide.max(needed);
        let next = motion.follow(&placements, &program, slots);
        self.refuse_if_stopped()?;
        Ok(next)
    }

    fn refuse_if_stopped(&mut self) -> Result<(), Refusal> {
        if (self.is_stopped)() { Err(Refusal::Busy(Busy::DriveActive)) } else { Ok(()) }
    }
}

/// The shortest glide in samples in which no block changes a tone's step by more than [`MAX_STEP_CHANGE`].
///
/// On the way the step moves at most `k |dp|` per unit of glide time, with `k` the `steepest` interval crossed, and by
/// `d s'(u)`, `s' <= pi/2 < 2`, while a table swap blends.
fn shortest_glide(
    program: &Program,
    placement: &Placement,
    target: &Target,
    steepest: u32,
    slots: &TableSlots,
) -> u32 {
    let table = program.table;
    // Knots on the way in Q31, at most 2^41; times a step difference below 2^31: 72 bits.
    let way = u128::from(placement.position.raw().abs_diff(target.position.raw()))
        * u128::from(table.knots.saturating_sub(1));
    // Now in the unit of a step, Q64: from Q32 up by 32, from the place's Q31 down by 31.
    let glide = (way * u128::from(steepest)) << 1;
    let here = slots.evaluate(table, placement.position).step.0;
    let blend = u128::from(placement.setting.step.0.abs_diff(here)) * 2;
    let samples = (glide + blend) * BLOCK as u128 / u128::from(MAX_STEP_CHANGE);
    u32::try_from(samples).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests;
