//! The headroom light: the margin of an input below full scale.

use slipline_plate::calibrate::Measurement;
use slipline_plate::check::Colour;
use slipline_plate::quantity::{show_frequency, ticks};

/// Limits of the margin below full scale, dB: below the first an input is close to clipping, above the second its largest
/// response uses less than a hundredth of full scale.
pub const LIGHT_DB: (f64, f64) = (6.0, 40.0);

/// The light of a margin in dB: red below 6 dB, green to 40 dB, amber above.
#[must_use]
pub fn light(headroom_db: f64) -> Colour {
    match headroom_db {
        db if db < LIGHT_DB.0 => Colour::Red,
        db if db <= LIGHT_DB.1 => Colour::Green,
        _ => Colour::Amber,
    }
}

/// The margin of a measurement's input below full scale, at the frequency where it is least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Headroom {
    /// Margin below full scale, dB, and the frequency, Hz; `None` if the measurement does not state it.
    pub least: Option<(f64, f64)>,
}

impl Headroom {
    /// The headroom of a measurement.
    #[must_use]
    pub fn of(measurement: &Measurement) -> Self {
        let known =
            measurement.points.iter().filter_map(|point| Some((point.headroom_db?, point.frequency_hz)));
        Self { least: known.min_by(|a, b| a.0.total_cmp(&b.0)) }
    }

    /// Red below 6 dB, green to 40 dB, amber above.
    #[must_use]
    pub fn colour(&self) -> Colour {
        self.least.map_or(Colour::Unchecked, |(db, _)| light(db))
    }

    /// The meaning of the light and its remedy.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Some((db, frequency_hz)) = self.least else {
            return "The file does not state the input's headroom.".to_owned();
        };
        let (room, at) = (ticks::label(db, 0.1), show_frequency(frequency_hz));
        match self.colour() {
            Colour::Red if db <= 0.0 => {
                format!("The input was clipped at {at}: lower the level or the input's gain.")
            }
            Colour::Red => format!("{room} dB left at {at}: lower the level or the input's gain."),
            Colour::Amber => format!("{room} dB left: raise the level or the input's gain."),
            Colour::Green | Colour::Unchecked => format!("{room} dB left at {at}."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::Complex64;
    use slipline_plate::calibrate::{MeasuredPoint, SensorKind};

    #[test]
    fn the_fullest_answer_sets_the_light() {
        let of = |least: Option<f64>| {
            let point = |i: u32| MeasuredPoint {
                frequency_hz: 100.0 + f64::from(i),
                response: Complex64::ONE,
                noise: 0.01,
                headroom_db: if i == 5 { least } else { least.map(|db| db + 1.0) },
            };
            let points = (0..10).map(point).collect();
            Headroom::of(&Measurement::at(0.03, SensorKind::Velocity, points))
        };
        for (db, colour, words) in [
            (-0.1, Colour::Red, "clipped at 105.0 Hz"),
            (5.9, Colour::Red, "5.9 dB left at 105.0 Hz: lower"),
            (6.0, Colour::Green, "6.0 dB left at 105.0 Hz."),
            (40.0, Colour::Green, "40.0 dB left"),
            (40.1, Colour::Amber, "40.1 dB left: raise"),
        ] {
            let light = of(Some(db));
            assert!(light.colour() == colour && light.sentence().contains(words), "{db}: {light:?}");
        }
        assert_eq!(of(None).colour(), Colour::Unchecked);
    }
}
