//! The rings: the envelope of the simulated plate beside the predicted one, as the stage draws and exports state it.

use super::steady_field::SteadyField;
use super::time_domain::SimulatedField;
use std::borrow::Cow;

/// The envelope of the simulated plate.
#[derive(Clone, Debug)]
pub struct Rings<'a> {
    /// Its points; they are copied only where they are multiplied.
    pub field: Cow<'a, SimulatedField>,
    /// Whether it belongs to the drive that sounds: during a drag that of the previous drive stays.
    pub is_current: bool,
    /// The factor by which all values of a hidden test plate were multiplied. The sensor on such a plate has no known
    /// sensitivity, so its level is not known: its highest point gets the height of the predicted one.
    pub fitted: Option<f64>,
}

impl<'a> Rings<'a> {
    /// The rings of a plate, or of a hidden test plate whose level is fitted to this prediction.
    #[must_use]
    pub fn new(field: &'a SimulatedField, is_current: bool, hidden_under: Option<&SteadyField>) -> Self {
        let mut field = Cow::Borrowed(field);
        let highest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let fitted = hidden_under.and_then(|predicted| {
            let own_m = highest(&mut field.points().map(|(_, metres)| metres));
            (own_m > 0.0).then(|| highest(&mut predicted.drawn_m().into_iter()) / own_m)
        });
        if let Some(factor) = fitted {
            let field = field.to_mut();
            field.maximum_m.iter_mut().chain(&mut field.rms_m).for_each(|metres| *metres *= factor);
        }
        Self { field, is_current, fitted }
    }

    /// The same with points of their own, for a figure that is drawn elsewhere.
    #[must_use]
    pub fn to_owned_rings(&self) -> Rings<'static> {
        Rings {
            field: Cow::Owned(self.field.as_ref().clone()),
            is_current: self.is_current,
            fitted: self.fitted,
        }
    }

    /// What they are of, for a legend.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self.fitted {
            Some(_) => "hidden test plate, level fitted",
            None => "simulated plate",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::steady_field::steady_tones;
    use crate::setup::Setup;
    use slipline_plate::DriveTable;
    use std::sync::Arc;

    #[test]
    fn a_hidden_plates_highest_ring_is_as_high_as_the_curve_and_the_factor_is_stated() {
        let setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
        let table = DriveTable::build(&setup.plate, 400e3, 17).unwrap();
        let predicted = SteadyField::solve(&setup.plate, &steady_tones(&setup, Some(&table)));
        let field = SimulatedField {
            number: 1,
            position_m: vec![0.1, 0.2],
            maximum_m: vec![2e-6, 4e-6],
            rms_m: vec![1e-6, 2e-6],
            tones: 1,
        };
        let own = Rings::new(&field, true, None);
        assert_eq!((own.field.maximum_m.as_slice(), own.fitted), (&[2e-6, 4e-6][..], None));
        let hidden = Rings::new(&field, true, Some(&predicted));
        let top_m = predicted.drawn_m().into_iter().fold(0.0, f64::max);
        let factor = hidden.fitted.unwrap();
        assert!((factor * 4e-6 / top_m - 1.0).abs() < 1e-12 && factor != 1.0);
        assert!((hidden.field.maximum_m[1] / top_m - 1.0).abs() < 1e-12);
        assert!((hidden.field.rms_m[0] / (factor * 1e-6) - 1.0).abs() < 1e-12);
        let still = SimulatedField { maximum_m: vec![0.0; 2], rms_m: vec![0.0; 2], ..field };
        assert_eq!(Rings::new(&still, true, Some(&predicted)).fitted, None);
    }
}
