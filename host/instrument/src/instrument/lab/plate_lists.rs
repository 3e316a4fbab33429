//! The lists of measurements, one for each plate: a measurement belongs to the plate that was measured.

use slipline_model::response::Shelf;
use slipline_plate::Plate;

/// The list of the plate on the screen, and those of others.
pub(super) struct PlateLists {
    present: PlateList,
    others: Vec<PlateList>,
}

/// What was measured of one plate.
struct PlateList {
    /// The names under which its plates are shown: that of its file, and those of plates that were calibrated on it.
    names: Vec<String>,
    /// The number of the unknown plate under the simulated device, if that is measured.
    draw: Option<u64>,
    shelf: Shelf,
    /// Number of runs with the device that gave a measurement.
    runs: u32,
}

impl PlateList {
    fn new(plate: &Plate, draw: Option<u64>) -> Self {
        Self { names: vec![plate.name().to_owned()], draw, shelf: Shelf::default(), runs: 0 }
    }

    fn is_of(&self, plate: &Plate, draw: Option<u64>) -> bool {
        self.draw == draw && self.names.iter().any(|name| name == plate.name())
    }
}

impl PlateLists {
    /// The empty list of this plate.
    pub(super) fn new(plate: &Plate) -> Self {
        Self { present: PlateList::new(plate, None), others: Vec::new() }
    }

    /// The list of the plate on the screen.
    pub(super) const fn shelf(&self) -> &Shelf {
        &self.present.shelf
    }

    /// As [`Self::shelf`], to change it.
    pub(super) const fn shelf_mut(&mut self) -> &mut Shelf {
        &mut self.present.shelf
    }

    /// Turns to the list of this plate, which is new if it was never measured. A plate of the same name is the same plate with
    /// other numbers; `draw` is the number of the unknown plate that is measured, if there is one.
    pub(super) fn turn_to(&mut self, plate: &Plate, draw: Option<u64>) {
        if self.present.is_of(plate, draw) {
            return;
        }
        let known = self.others.iter().position(|other| other.is_of(plate, draw));
        let next = known.map_or_else(|| PlateList::new(plate, draw), |at| self.others.swap_remove(at));
        let before = std::mem::replace(&mut self.present, next);
        if !before.shelf.entries().is_empty() {
            self.others.push(before);
        }
    }

    /// This plate was calibrated on the one of the present list.
    pub(super) fn is_described_by(&mut self, calibrated: &Plate) {
        self.present.names.push(calibrated.name().to_owned());
    }

    /// Counts a run with the device; returns its number.
    pub(super) const fn count_run(&mut self) -> u32 {
        self.present.runs += 1;
        self.present.runs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::Complex64;
    use slipline_plate::calibrate::{MeasuredPoint, Measurement, SensorKind};

    fn measure(lists: &mut PlateLists) -> String {
        let point = |i: u32| MeasuredPoint {
            frequency_hz: 100.0 + f64::from(i),
            response: Complex64::ONE,
            noise: 0.01,
            headroom_db: None,
        };
        let measurement = Measurement::at(0.1, SensorKind::Velocity, (0..10).map(point).collect());
        let name = format!("run {}", lists.count_run());
        lists.shelf_mut().add(&name, measurement).unwrap();
        name
    }

    #[test]
    fn each_plate_has_its_own_list_and_a_calibrated_one_shares_that_of_its_plate() {
        let preset = |name| slipline_plate::preset(name).unwrap();
        let (membrane, bending) = (preset("membrane"), preset("al-bending"));
        let mut lists = PlateLists::new(&membrane);
        let count = |lists: &PlateLists| lists.shelf().entries().len();
        assert_eq!([measure(&mut lists), measure(&mut lists)], ["run 1", "run 2"]);
        lists.turn_to(&bending, None);
        assert_eq!((count(&lists), measure(&mut lists)), (0, "run 1".to_owned()), "a fresh plate has none");
        lists.turn_to(&membrane.with_wave_speed(1.1).unwrap(), None);
        assert_eq!(count(&lists), 2, "the same plate with another number");
        // As the calibrated plate would be called in its file.
        lists.is_described_by(&preset("membrane-heavy"));
        lists.turn_to(&preset("membrane-heavy"), None);
        assert_eq!(count(&lists), 2);
        // An unknown plate under the sensor is another one, and so is the next.
        for draw in [Some(1), Some(2)] {
            lists.turn_to(&membrane, draw);
            assert_eq!(count(&lists), 0, "{draw:?}");
            measure(&mut lists);
        }
        lists.turn_to(&membrane, None);
        assert_eq!(count(&lists), 2, "what was measured before is there again");
    }
}
