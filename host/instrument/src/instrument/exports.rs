//! What is exported of the screen: the same numbers under the same names, at the same scale.

use super::Shown;
use slipline_model::export::csv_wav;
#[cfg(feature = "figures")]
use slipline_model::export::figures::plate::Subject;
use slipline_model::field::rings::Rings;

impl Shown<'_> {
    /// The rings that belong to what is on the screen: during a drag those of the previous drive stay, and are not exported.
    fn current_rings(&self) -> Option<&Rings<'_>> {
        self.measured.as_ref().filter(|rings| rings.is_current)
    }

    /// The envelope as CSV; `None` while the peak at level 1 is not known.
    #[must_use]
    pub fn envelope_csv(&self) -> Option<String> {
        let rings = self.current_rings();
        Some(csv_wav::envelope_csv(self.setup, self.predicted, rings, self.full_peak_m?))
    }

    /// The stage as a figure, with displacements this many times larger than to the table's full scale, coloured by the largest
    /// displacement or by the present one; `None` while the peak at level 1 is not known.
    #[cfg(feature = "figures")]
    #[must_use]
    pub fn figure(&self, magnification: f64, is_largest: bool) -> Option<Subject> {
        Some(Subject {
            setup: self.setup.clone(),
            predicted: self.predicted.clone(),
            sounding: self.sounding.cloned(),
            sheet: self.sheet.cloned(),
            measured: self.current_rings().map(Rings::to_owned_rings),
            full_peak_m: self.full_peak_m?,
            magnification,
            is_largest,
            wave_time_s: self.wave_time_s,
        })
    }
}
