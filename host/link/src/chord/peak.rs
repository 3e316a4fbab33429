//! The peak of a chord, by the device's own computation.

use super::ChordRequest;
use crate::table::DeviceTable;
use slipline_app::dds::bank::FULL_SCALE;
use slipline_app::planning::chord::{ChordTones, Extent, Proof};
use slipline_protocol::command::Chord;
use slipline_protocol::event::Identity;
use slipline_protocol::refusal::Refusal;

impl ChordRequest {
    /// The same chord with its master level lowered until its peak with this table fits `linear`, the share of full scale within
    /// which the DAC's output is linear, 0 to 1; rounding of levels and phases may raise a peak above it.
    ///
    /// # Errors
    /// [`Refusal`](crate::Refusal) as [`ChordRequest::for_device`]; what the device would refuse at any master level.
    pub fn fitted(
        mut self,
        identity: &Identity,
        table: &DeviceTable,
        linear: f64,
    ) -> Result<Self, crate::Refusal> {
        let full_scale = linear * f64::from(FULL_SCALE);
        let chord = self.for_device(identity, None)?;
        let peak = f64::from(extent(&chord, table).map_err(crate::Refusal::Device)?.peak());
        if peak > full_scale {
            // The device's unit is a hundredth of a decibel.
            self.master_db -= 20.0 * (peak / full_scale).log10() + 0.01;
        }
        Ok(self)
    }
}

/// Lowest and highest sample of a chord after its rise, by the device's own computation with this table.
///
/// # Errors
/// What the device would refuse: a multiple outside the table's frequencies, or a sum of amplitudes that fits
/// with no phases.
pub fn extent(chord: &Chord, table: &DeviceTable) -> Result<Extent, Refusal> {
    let knot = |index: u16| table.knots().get(usize::from(index)).copied().unwrap_or_default();
    let tones = ChordTones::of(chord, table.header().knots, knot)?;
    tones.check_sum()?;
    Proof::new().extent(&tones, &mut || false)
}
