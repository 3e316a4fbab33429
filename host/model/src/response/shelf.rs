//! The list of measurements: one is chosen, the others are overlays that can be shown, hidden and removed.

use super::bode::Bode;
use slipline_plate::calibrate::Measurement;
use slipline_plate::quantity::must_be;
use std::sync::Arc;

/// Most measurements in a list.
pub(crate) const MEASUREMENTS_MAX: usize = 32;

/// A measurement in the list.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Increases with each measurement: it keeps its colour when others are removed.
    pub number: u64,
    /// The name of its file or of the run.
    pub name: String,
    /// The measurement.
    pub measurement: Arc<Measurement>,
    /// Its curves.
    pub bode: Arc<Bode>,
    /// Whether it is drawn.
    pub is_shown: bool,
}

/// The list is full.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{}", must_be(
    format_args!("{} measurements", MEASUREMENTS_MAX + 1),
    format_args!("at most {MEASUREMENTS_MAX}: remove one first"),
))]
pub struct ShelfFull;

/// The list.
#[derive(Debug, Clone, Default)]
pub struct Shelf {
    entries: Vec<Entry>,
    chosen: Option<u64>,
    count: u64,
}

impl Shelf {
    /// Adds and chooses a measurement. If one of the same name and numbers exists, it is chosen instead.
    ///
    /// # Errors
    /// If there are 32 already.
    pub fn add(&mut self, name: &str, measurement: Measurement) -> Result<u64, ShelfFull> {
        let same = |entry: &&Entry| entry.name == name && *entry.measurement == measurement;
        if let Some(same) = self.entries.iter().find(same).map(|entry| entry.number) {
            self.show(same, true);
            self.choose(same);
            return Ok(same);
        }
        if self.entries.len() >= MEASUREMENTS_MAX {
            return Err(ShelfFull);
        }
        self.count += 1;
        let bode = Arc::new(Bode::of(&measurement));
        let (number, name, measurement) = (self.count, name.to_owned(), Arc::new(measurement));
        self.entries.push(Entry { number, name, measurement, bode, is_shown: true });
        self.chosen = Some(number);
        Ok(number)
    }

    /// All measurements, the oldest first.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The measurement of this number.
    #[must_use]
    pub fn entry(&self, number: u64) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.number == number)
    }

    /// The chosen measurement: its values are shown, and the plate's model is compared with it.
    #[must_use]
    pub fn chosen(&self) -> Option<&Entry> {
        self.chosen.and_then(|number| self.entry(number))
    }

    /// Chooses and draws a measurement.
    pub fn choose(&mut self, number: u64) {
        if self.entry(number).is_some() {
            self.chosen = Some(number);
            self.show(number, true);
        }
    }

    /// Draws or hides a measurement.
    pub fn show(&mut self, number: u64, is_shown: bool) {
        for entry in self.entries.iter_mut().filter(|entry| entry.number == number) {
            entry.is_shown = is_shown;
        }
    }

    /// Removes a measurement. If it was chosen, the newest of the others is chosen.
    pub fn remove(&mut self, number: u64) {
        self.entries.retain(|entry| entry.number != number);
        if self.chosen == Some(number) {
            self.chosen = self.entries.last().map(|entry| entry.number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::Complex64;
    use slipline_plate::calibrate::{MeasuredPoint, SensorKind};

    fn measurement(place_m: f64) -> Measurement {
        let point = |i: u32| MeasuredPoint {
            frequency_hz: 100.0 + f64::from(i),
            response: Complex64::ONE,
            noise: 0.01,
            headroom_db: None,
        };
        Measurement::at(place_m, SensorKind::Velocity, (0..10).map(point).collect())
    }

    #[test]
    fn the_newest_is_chosen_and_numbers_stay_when_one_is_removed() {
        let mut shelf = Shelf::default();
        let numbers: Vec<u64> =
            (0..3).map(|i| shelf.add("left.csv", measurement(0.01 * f64::from(i))).unwrap()).collect();
        assert_eq!(shelf.chosen().unwrap().number, numbers[2]);
        shelf.show(numbers[0], false);
        shelf.choose(numbers[0]);
        assert!(shelf.chosen().unwrap().is_shown, "what is chosen is drawn");
        shelf.remove(numbers[0]);
        assert_eq!(shelf.chosen().unwrap().number, numbers[2]);
        assert!(shelf.entry(numbers[0]).is_none() && shelf.entry(numbers[1]).is_some());
        shelf.choose(99);
        assert_eq!(shelf.chosen().unwrap().number, numbers[2]);
    }

    #[test]
    fn the_same_file_is_in_the_list_once_and_a_full_list_is_reported() {
        let mut shelf = Shelf::default();
        for i in 0..MEASUREMENTS_MAX {
            shelf.add("a.csv", measurement(0.001 * i as f64)).unwrap();
        }
        assert_eq!(shelf.add("a.csv", measurement(0.0)), Ok(1));
        assert_eq!(shelf.chosen().unwrap().number, 1);
        let refused = shelf.add("a.csv", measurement(0.3)).unwrap_err();
        assert_eq!(refused.to_string(), "33 measurements: must be at most 32: remove one first");
        assert_eq!(shelf.entries().len(), MEASUREMENTS_MAX);
    }
}
