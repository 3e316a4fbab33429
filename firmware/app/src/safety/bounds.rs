//! The bounds of the actuator's profile, which hold for every host: amplitude, travel, heat, rise and time.
//!
//! A motion that passes them is refused, as by the bounds that hold without a profile; nothing is scaled. Without a profile nothing
//! here refuses anything.
//!
//! The amplitudes are judged as the headroom is (`headroom`): `G_i` is the largest gain on a tone's way, all levels share one `s`, and
//! `sum G_i level_i(s)` is linear in `s`, so it is largest at one of the ends. Where a motion ends silent the levels only fall: it is
//! judged only if a tone changes its gain meanwhile. So a chord, whose sum may be larger, can always fade where it is.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use slipline_protocol::event::{Fault, ProfileReport, StoredConfig};
use slipline_protocol::limits::{self, MAX_RISE_CDB};
use slipline_protocol::profile::ActuatorProfile;
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::timing::Timing;
use slipline_protocol::units::Gain;

use crate::motion::Motion;
use crate::motion::trajectory::{SettingTrajectory, ToneTrajectory};
use crate::range::within;
use crate::safety::excursion::Excursion;
use crate::safety::thermal::CoilConstants;
use crate::slots::{TableRef, TableSlots};

/// The profile in force and what follows from it.
pub struct Bounds {
    profile: Option<ActuatorProfile>,
    stored: StoredConfig,
    /// The profile's limit of the travel.
    pub(crate) travel: Excursion,
}

impl Bounds {
    /// No profile, at a sample rate in Hz.
    #[must_use]
    pub const fn none(sample_rate_hz: u32) -> Self {
        Self { profile: None, stored: StoredConfig::Empty, travel: Excursion::unlimited(sample_rate_hz) }
    }

    /// Puts a profile in force, or none; `tables` are those that the slots hold already.
    ///
    /// # Errors
    /// As [`check`]; nothing has changed then.
    pub fn set(
        &mut self,
        profile: Option<ActuatorProfile>,
        tables: [TableRef; 2],
        slots: &TableSlots,
    ) -> Result<(), Refusal> {
        if let Some(profile) = &profile {
            check(profile)?;
        }
        self.travel.set(profile.as_ref().and_then(|profile| profile.travel), tables, slots)?;
        self.profile = profile;
        Ok(())
    }

    /// Notes how the flash was found.
    pub const fn found(&mut self, stored: StoredConfig) {
        self.stored = stored;
    }

    /// The fault that keeps the device from being armed: a profile may have been lost, or an older one is in force.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        match self.stored {
            StoredConfig::Damaged => Some(Fault::StoreDamaged),
            StoredConfig::FellBack => Some(Fault::ProfileFellBack),
            StoredConfig::Empty | StoredConfig::Loaded | StoredConfig::WrongVersion => None,
        }
    }

    /// Accepts the older profile for this run, as its user does with a hand on the board.
    pub const fn accept_older(&mut self) {
        if matches!(self.stored, StoredConfig::FellBack) {
            self.stored = StoredConfig::Loaded;
        }
    }

    /// Whether the flash keeps a profile, or may have lost one.
    #[must_use]
    pub const fn is_kept(&self) -> bool {
        self.profile.is_some() || self.fault().is_some()
    }

    /// The report to the host.
    #[must_use]
    pub fn report(&self) -> ProfileReport {
        ProfileReport { profile: self.profile.clone(), stored: self.stored }
    }

    /// The coil's constants.
    #[must_use]
    pub fn coil(&self) -> CoilConstants {
        self.profile.as_ref().map_or(CoilConstants::DEFAULT, |profile| CoilConstants::of(&profile.heat))
    }

    /// The largest rise of a level hold, in hundredths of a decibel.
    #[must_use]
    pub fn max_rise_cdb(&self) -> i16 {
        self.profile.as_ref().map_or(MAX_RISE_CDB, |profile| profile.max_rise.0)
    }

    /// The longest drive without a command of the user, in samples.
    #[must_use]
    pub fn max_drive(&self, timing: &Timing) -> u64 {
        self.profile.as_ref().map_or(timing.max_drive, |profile| timing.samples(profile.max_drive_ms))
    }

    /// Whether a stop input is fitted; `None` without a profile.
    #[must_use]
    pub fn has_stop_input(&self) -> Option<bool> {
        self.profile.as_ref().map(|profile| profile.has_stop_input)
    }

    /// The largest sum of amplitudes, Q1.31.
    #[must_use]
    pub fn ceiling(&self) -> Gain {
        let Some(profile) = &self.profile else { return Gain::FULL };
        let share = u64::from(Gain::FULL.0).saturating_mul(profile.max_sum_per_mille.into()) / 1000;
        Gain(u32::try_from(share).unwrap_or(u32::MAX))
    }

    /// Checks that a motion of tones that do not prove their peak keeps within the amplitudes.
    ///
    /// # Errors
    /// [`Refusal::Headroom`].
    pub fn check_sum(&self, motion: &Motion, slots: &TableSlots) -> Result<(), Refusal> {
        let only_falls = motion.ends_silent() && motion.trajectories().iter().all(keeps_its_gain);
        if self.profile.is_none() || only_falls {
            return Ok(());
        }
        let (mut at_start, mut at_end) = (0_u64, 0_u64);
        for tone in motion.trajectories() {
            let gain = largest_gain(tone, motion.table(), slots);
            at_start = at_start.saturating_add(gain.times(tone.from_level).0.into());
            at_end = at_end.saturating_add(gain.times(tone.to_level).0.into());
        }
        Refusal::check_sum(at_start.max(at_end), self.ceiling())
    }
}

fn keeps_its_gain(tone: &ToneTrajectory) -> bool {
    match tone.setting {
        SettingTrajectory::Hold { .. } => true,
        SettingTrajectory::Along => tone.from == tone.to,
        SettingTrajectory::Join { .. } => false,
    }
}

/// The largest gain on a tone's way.
fn largest_gain(tone: &ToneTrajectory, table: TableRef, slots: &TableSlots) -> Gain {
    let on_the_table = || {
        if tone.from == tone.to {
            // At rest the interpolated value is exact, and lower than a knot beside it.
            slots.evaluate(table, tone.to).gain.0
        } else {
            slots.extremes(table, tone.from, tone.to).gain
        }
    };
    match tone.setting {
        SettingTrajectory::Hold { gain, .. } => gain,
        SettingTrajectory::Along => Gain(on_the_table()),
        SettingTrajectory::Join { gain, .. } => {
            Gain(on_the_table().saturating_add_signed(gain.max(0)).min(Gain::FULL.0))
        }
    }
}

/// Checks a profile's values.
///
/// # Errors
/// [`Refusal::OutOfRange`] with the field.
pub fn check(profile: &ActuatorProfile) -> Result<(), Refusal> {
    within(Field::ProfileSum, limits::PROFILE_SUM_PER_MILLE, profile.max_sum_per_mille)?;
    for time in [profile.heat.winding_ms, profile.heat.body_ms] {
        within(Field::CoilTime, limits::COIL_TIME_MS, time)?;
    }
    within(Field::FullSine, limits::FULL_SINE_PER_MILLE, profile.heat.full_sine_per_mille)?;
    within(Field::DriveTime, (limits::MIN_DRIVE_MS, limits::MAX_DRIVE_MS), profile.max_drive_ms)?;
    Refusal::check(Field::MaxRise, 0, MAX_RISE_CDB.into(), profile.max_rise.0.into())?;
    profile.travel.as_ref().map_or(Ok(()), crate::safety::excursion::check_ranges)
}
