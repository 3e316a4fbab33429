//! The tour: six steps over the real controls. Each opens the page of its control, says in a sentence what to do, and is done
//! when the user has done it; the user goes on whenever they like. Nothing is done for the user, except that the simulated plate
//! is driven at the beginning and a finger that takes nothing is laid on it for its step.

use super::Instrument;
use super::shell::{Output, Page};
use slipline_model::field::touch::Touch;
use slipline_plate::Plate;
use std::sync::Arc;

/// A line or a finger that has moved by this much was moved on purpose, in metres.
const MOVED_M: f64 = 5e-3;

/// A step of the tour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TourStep {
    /// Drag the line.
    Line,
    /// Move the finger.
    Finger,
    /// Play a texture.
    Texture,
    /// Measure the plate.
    Measure,
    /// Begin a calibration.
    Calibrate,
    /// Choose another plate.
    OwnPlate,
}

impl TourStep {
    /// In their order.
    pub const ALL: [Self; 6] =
        [Self::Line, Self::Finger, Self::Texture, Self::Measure, Self::Calibrate, Self::OwnPlate];

    /// Its number, from 1.
    #[must_use]
    pub fn number(self) -> usize {
        Self::ALL.iter().position(|step| *step == self).unwrap_or(0) + 1
    }

    /// What it is about.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Line => "The line",
            Self::Finger => "The finger",
            Self::Texture => "A texture",
            Self::Measure => "Measure",
            Self::Calibrate => "Calibrate",
            Self::OwnPlate => "Your own plate",
        }
    }

    /// What to do, and what it shows.
    #[must_use]
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Line => {
                "Drag the line along the plate. The plate vibrates up to it and is still beyond it."
            }
            Self::Finger => {
                "Drag the fingertip across the line. The strip below the curve shows what it feels."
            }
            Self::Texture => {
                "Press Play this. Several tones together make an even area, a profile or stripes."
            }
            Self::Measure => {
                "Tick Hidden test plate and press Measure now. Its response is drawn beside what the file says."
            }
            Self::Calibrate => {
                "Press Calibrate. Two measurements fit the file to the plate; B then shows before and after."
            }
            Self::OwnPlate => {
                "Choose one of the plates, or your own from a file. The designer makes one for a band."
            }
        }
    }

    /// The page of its control.
    const fn page(self) -> Page {
        match self {
            Self::Line | Self::Finger => Page::Boundary,
            Self::Texture => Page::Texture,
            Self::Measure | Self::Calibrate => Page::Measurements,
            Self::OwnPlate => Page::Plate,
        }
    }

    fn beside(self, steps: isize) -> Option<Self> {
        let at = self.number().checked_add_signed(steps)?.checked_sub(1)?;
        Self::ALL.get(at).copied()
    }
}

/// The tour as it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TourScene {
    /// The present step.
    pub step: TourStep,
    /// Whether the user has done what it says.
    pub is_done: bool,
}

/// A tour under way.
pub(super) struct Tour {
    scene: TourScene,
    begun_with: Begun,
}

/// What a step began with.
struct Begun {
    line_m: Option<f64>,
    finger_m: f64,
    tones: usize,
    plate: Arc<Plate>,
    measurements: usize,
}

impl Instrument {
    /// Begins the tour, again if it is under way, and drives the simulated plate.
    pub fn begin_tour(&mut self) {
        self.start_simulated();
        self.open_step(TourStep::Line);
    }

    /// Goes to the next step, or ends the tour after the last.
    pub fn next_step(&mut self) {
        self.step_by(1);
    }

    /// Goes back to the step before.
    pub fn step_back(&mut self) {
        self.step_by(-1);
    }

    /// Ends the tour; what was done in it stays.
    pub fn end_tour(&mut self) {
        self.tour = None;
    }

    /// The tour under way.
    pub(super) fn tour_scene(&self) -> Option<TourScene> {
        self.tour.as_ref().map(|tour| tour.scene)
    }

    fn step_by(&mut self, steps: isize) {
        let Some(tour) = &self.tour else { return };
        match tour.scene.step.beside(steps) {
            Some(step) => self.open_step(step),
            None if steps > 0 => self.tour = None,
            None => {}
        }
    }

    fn open_step(&mut self, step: TourStep) {
        if step == TourStep::Finger && self.screen.finger().is_none() {
            self.touch(Touch::Ideal);
        }
        self.out.push(Output::Open(step.page()));
        let begun_with = self.begun();
        self.tour = Some(Tour { scene: TourScene { step, is_done: false }, begun_with });
    }

    fn begun(&self) -> Begun {
        Begun {
            line_m: self.line(self.desk.selected()).map(|line| line.place_m),
            finger_m: self.screen.finger_place_m(),
            tones: self.desk.setup().tones.len(),
            plate: Arc::clone(self.desk.plate()),
            measurements: self.lab.drawn().count(),
        }
    }

    /// Notes whether the user has done what the present step says.
    pub(super) fn advance_tour(&mut self) {
        let Some(Tour { scene: TourScene { step, is_done: false }, begun_with }) = &self.tour else { return };
        let now = self.begun();
        let is_far = |from_m: f64, to_m: f64| (to_m - from_m).abs() >= MOVED_M;
        let is_done = match step {
            TourStep::Line => {
                begun_with.line_m.zip(now.line_m).is_some_and(|(from_m, to_m)| is_far(from_m, to_m))
            }
            TourStep::Finger => is_far(begun_with.finger_m, now.finger_m),
            TourStep::Texture => now.tones != begun_with.tones,
            TourStep::Measure => self.lab.is_measuring() || now.measurements != begun_with.measurements,
            TourStep::Calibrate => self.lab.calibration_scene().is_some(),
            TourStep::OwnPlate => !Arc::ptr_eq(&now.plate, &begun_with.plate),
        };
        if let Some(tour) = &mut self.tour {
            tour.scene.is_done = is_done;
        }
    }
}
