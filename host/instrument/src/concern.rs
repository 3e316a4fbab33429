//! What the lights of a check mean to the user of a device: amber and red are for what does not work or may harm; all else
//! that a light says is a note.
//!
//! `check`, its JSON and its exit code are about a plate alone and grade by the thresholds of the plate's crate; here stands
//! what a window shows of that, beside a device.

use slipline_link::Snapshot;
use slipline_plate::check::{Colour, Light, Report};
use slipline_plate::order;

/// What a light asks of the user, in rising order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Concern {
    /// The plate file lacks an input of this check.
    Unchecked,
    /// Nothing.
    Green,
    /// A limitation, which the sentence states: nothing fails, nothing is harmed.
    Note,
    /// Something does not work, or may harm if it lasts.
    Amber,
    /// Something does not work, or harms.
    Red,
}

/// Lights about what a driven plate does to people and actuators: a simulated plate makes no sound and no heat and moves
/// nothing.
const HAZARDS: [&str; 2] = ["sound level", "excursion"];

/// Lights whose amber says that the boundary cannot be felt. That of the other lights says how well the model describes it.
const FAILURES: [&str; 1] = ["felt edge"];

impl Concern {
    /// The concern of a light; `is_real` says whether a real device moves a real plate.
    #[must_use]
    pub fn of(light: &Light, is_real: bool) -> Self {
        let is_hazard = HAZARDS.contains(&light.name);
        match light.colour {
            Colour::Amber | Colour::Red if is_hazard && !is_real => Self::Note,
            Colour::Amber if !is_hazard && !FAILURES.contains(&light.name) => Self::Note,
            Colour::Unchecked | Colour::Green | Colour::Amber | Colour::Red => light.colour.into(),
        }
    }

    /// The concern as a word: `unchecked`, `green`, `note`, `amber` or `red`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unchecked => "unchecked",
            Self::Green => "green",
            Self::Note => "note",
            Self::Amber => "amber",
            Self::Red => "red",
        }
    }
}

impl From<Colour> for Concern {
    fn from(colour: Colour) -> Self {
        match colour {
            Colour::Unchecked => Self::Unchecked,
            Colour::Green => Self::Green,
            Colour::Amber => Self::Amber,
            Colour::Red => Self::Red,
        }
    }
}

/// Presets whose lights are red by nature, and one whose lights are all green.
const RED: [&str; 4] = ["al-bending-displacement", "al-sh", "paper-as-printed", "paper-rubber"];
const GREEN: [&str; 1] = ["tungsten-membrane"];

/// The worst concern of a preset as it opens beside the simulated device; its description says why it is red.
#[must_use]
pub fn of_preset(name: &str) -> Concern {
    if RED.contains(&name) {
        Concern::Red
    } else if GREEN.contains(&name) {
        Concern::Green
    } else {
        Concern::Note
    }
}

/// Whether a real plate moves: a real device is connected.
#[must_use]
pub fn is_real(snapshot: &Snapshot) -> bool {
    snapshot.is_connected() && !snapshot.is_simulated()
}

/// The lights of a report with their concerns.
#[derive(Debug, Clone)]
pub struct Concerns<'a> {
    /// The worst first; lights of the same concern keep their order.
    pub lights: Vec<(Concern, &'a Light)>,
}

impl<'a> Concerns<'a> {
    /// Those of a report; `is_real` as for [`Concern::of`].
    #[must_use]
    pub fn of(report: &'a Report, is_real: bool) -> Self {
        let mut lights: Vec<_> =
            report.lights.iter().map(|light| (Concern::of(light, is_real), light)).collect();
        order::sort_by_key(&mut lights, |(concern, _)| std::cmp::Reverse(*concern));
        Self { lights }
    }

    /// The worst concern; green if there is none.
    #[must_use]
    pub fn worst(&self) -> Concern {
        self.lights.first().map_or(Concern::Green, |(concern, _)| (*concern).max(Concern::Green))
    }

    /// The number of lights that ask for this.
    #[must_use]
    pub fn count(&self, concern: Concern) -> usize {
        self.lights.iter().filter(|(of, _)| *of == concern).count()
    }

    /// In a few words: `all green`, `3 notes`, or `1 red, 2 amber`.
    #[must_use]
    pub fn summary(&self) -> String {
        let [red, amber, notes] = [Concern::Red, Concern::Amber, Concern::Note].map(|of| self.count(of));
        match (red, amber, notes) {
            (0, 0, 0) => "all green".to_owned(),
            (0, 0, 1) => "1 note".to_owned(),
            (0, 0, _) => format!("{notes} notes"),
            (0, ..) => format!("{amber} amber"),
            (_, 0, _) => format!("{red} red"),
            _ => format!("{red} red, {amber} amber"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::check::{Checker, Conditions};

    fn report(preset: &str, boundary_m: f64) -> Report {
        let plate = slipline_plate::preset(preset).unwrap();
        Checker::new(&plate, Conditions::default()).unwrap().at(boundary_m).unwrap()
    }

    #[test]
    fn what_harms_a_real_plate_is_a_note_on_a_simulated_one_and_the_check_grades_it_as_before() {
        let report = report("al-bending", 0.223);
        let sound = report.light("sound level").unwrap();
        assert_eq!(sound.colour, Colour::Red);
        assert_eq!([false, true].map(|is_real| Concern::of(sound, is_real)), [Concern::Note, Concern::Red]);
        let (here, there) = (Concerns::of(&report, false), Concerns::of(&report, true));
        assert_eq!((here.worst(), there.worst()), (Concern::Note, Concern::Red));
        assert!(here.summary().ends_with(" notes"), "{}", here.summary());
        assert_eq!(there.summary(), "1 red");
    }

    #[test]
    fn what_does_not_work_stays_red_on_every_device() {
        let report = report("al-bending-displacement", 0.223);
        for is_real in [false, true] {
            let concerns = Concerns::of(&report, is_real);
            let (worst, light) = concerns.lights[0];
            assert_eq!((worst, concerns.worst()), (Concern::Red, Concern::Red), "{light:?}");
        }
    }
}
