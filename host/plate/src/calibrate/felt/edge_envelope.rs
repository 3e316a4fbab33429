//! The felt edge of one tone on one plate as a function of its level.

use crate::definition::Plate;
use crate::feeling::{Feeling, FeltEdge};
use num_complex::Complex64;

/// Fall of a tone's field along the plate. At each place: the logarithm of the largest contact amplitude from there
/// to the end of the plate. The felt edge is where it falls below the logarithm of the smallest amplitude that is
/// felt.
#[derive(Debug, Clone)]
pub(crate) struct Envelope {
    from_here_on: Vec<f64>,
    step_m: f64,
}

impl Envelope {
    /// The envelope of a field sampled at equal distances from 0 to the plate's end, in any unit.
    pub(crate) fn of(field: &[Complex64], plate: &Plate, feeling: &Feeling) -> Self {
        let mut from_here_on = feeling.contact_amplitude(plate, field);
        let mut largest = f64::NEG_INFINITY;
        for amplitude in from_here_on.iter_mut().rev() {
            largest = largest.max(amplitude.ln());
            *amplitude = largest;
        }
        let step_m = plate.length_m() / (from_here_on.len() - 1) as f64;
        Self { from_here_on, step_m }
    }

    /// The felt edge for a smallest felt amplitude of exp(`least`), in the field's unit.
    pub(crate) fn edge(&self, least: f64) -> FeltEdge {
        let felt = self.from_here_on.partition_point(|amplitude| *amplitude >= least);
        let Some(last) = felt.checked_sub(1) else { return FeltEdge::Nowhere };
        let Some(beyond) = self.from_here_on.get(felt) else { return FeltEdge::PlateEnd };
        let here = self.from_here_on[last];
        FeltEdge::At((last as f64 + (here - least) / (here - beyond)) * self.step_m)
    }

    /// Place of the edge in metres; the driven end if nothing is felt, the plate's end if everything is.
    pub(crate) fn place_m(&self, least: f64) -> f64 {
        match self.edge(least) {
            FeltEdge::At(place_m) => place_m,
            FeltEdge::PlateEnd => (self.from_here_on.len() - 1) as f64 * self.step_m,
            FeltEdge::Nowhere => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::preset;
    use crate::feeling::FeltTone;
    use crate::{Equation, respond_batch};

    #[test]
    fn the_edge_of_every_level_matches_the_feeling() {
        for (name, frequency_hz, peak_m) in [("membrane", 140.0, 1e-5), ("al-bending", 28e3, 1e-6)] {
            let plate = preset(name).expect("a preset");
            let feeling = Feeling::default();
            let field =
                &respond_batch(&plate, &[frequency_hz], 1201, Equation::Corrected).expect("a field")[0];
            let envelope = Envelope::of(field, &plate, &feeling);
            let mut kinds = [0; 3];
            for exponent in -40..40 {
                let scale = peak_m * 10_f64.powf(0.1 * f64::from(exponent));
                let squares: Vec<f64> = field.iter().map(|f| 0.5 * (f * scale).norm_sqr()).collect();
                let tone = FeltTone { frequency_hz, squares: &squares };
                let wanted = Feeling::edge(&plate, &feeling.strength(&plate, &[tone]));
                let least = (feeling.just_felt_m(frequency_hz) / scale).ln();
                match (envelope.edge(least), wanted) {
                    (FeltEdge::At(found), FeltEdge::At(wanted)) => {
                        assert!((found - wanted).abs() < 2e-5, "{name} {exponent}: {found} {wanted}");
                        assert_eq!(envelope.place_m(least), found);
                        kinds[0] += 1;
                    }
                    (found, wanted) => {
                        assert_eq!(found, wanted, "{name} {exponent}");
                        kinds[if found == FeltEdge::Nowhere { 1 } else { 2 }] += 1;
                        let end_m = if found == FeltEdge::Nowhere { 0.0 } else { plate.length_m() };
                        assert!((envelope.place_m(least) - end_m).abs() < 1e-12);
                    }
                }
            }
            // On aluminium no level that can be played is felt up to the end.
            let reaches_end = name == "membrane";
            assert!(kinds[0] > 0 && kinds[1] > 0 && (kinds[2] > 0) == reaches_end, "{name}: {kinds:?}");
        }
    }
}
