//! The texture that a user of the window edits: one of four kinds, each with its values.

use super::making::Wish;
use slipline_plate::Plate;
use slipline_plate::quantity::OutOfRange;
use slipline_plate::texture::{TONES_MAX, TextureError};

/// A kind of texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WishKind {
    /// An even area.
    Solid,
    /// A drawn amplitude.
    #[default]
    Profile,
    /// The nodes of one tone.
    Stripes,
    /// Two tones that beat.
    Beat,
}

impl WishKind {
    /// Every kind, in the order of the page.
    pub const ALL: [Self; 4] = [Self::Solid, Self::Profile, Self::Stripes, Self::Beat];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Solid => "Solid",
            Self::Profile => "Profile",
            Self::Stripes => "Stripes",
            Self::Beat => "Beat",
        }
    }

    /// Its description in a sentence.
    #[must_use]
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Solid => "An even area from the driven end to where the finger feels it end.",
            Self::Profile => {
                "The wanted RMS amplitude along the plate: drag its points, or press between them for another."
            }
            Self::Stripes => "The nodes of one tone, with this spacing in the middle of its area.",
            Self::Beat => "Two tones that a finger feels rise and fall together, at the beat frequency.",
        }
    }
}

/// The values of every kind; each kind keeps its own while another is chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct WishDraft {
    /// The chosen kind.
    pub kind: WishKind,
    /// Felt end of an area, in metres.
    pub felt_edge_m: f64,
    /// The drawn amplitude: rising places in metres, each with its amplitude, 0..=1.
    pub profile: Vec<(f64, f64)>,
    /// RMS displacement of the profile's amplitude 1, in metres; `None`: as large as the tones allow.
    pub level_m: Option<f64>,
    /// Distance of stripes, in metres.
    pub stripes_m: f64,
    /// Place of a beat, in metres.
    pub beat_place_m: f64,
    /// Beat frequency, in Hz.
    pub beat_hz: f64,
    /// Largest number of tones, 1 to 16.
    pub most: usize,
}

/// Smallest number of breakpoints of a drawn profile.
pub(crate) const BREAKPOINTS_MIN: usize = 2;
/// Largest number of breakpoints of a drawn profile; a file may have more.
pub const BREAKPOINTS_DRAWN_MAX: usize = 32;
/// Smallest distance of two breakpoints, in metres.
const APART_M: f64 = 1e-3;
/// The beat of a new draft, in Hz: near where skin is most sensitive; in a narrow band this share of it.
const BEAT_HZ: f64 = 180.0;
const BEAT_SHARE: f64 = 0.2;

/// A positive number to two digits.
fn rounded(value: f64) -> f64 {
    let step = 10f64.powf(value.log10().floor() - 1.0);
    (value / step).round() * step
}

impl Wish {
    /// Its kind.
    #[must_use]
    pub const fn kind(&self) -> WishKind {
        match self {
            Self::Solid(_) => WishKind::Solid,
            Self::Profile(_) => WishKind::Profile,
            Self::Stripes(_) => WishKind::Stripes,
            Self::Beat { .. } => WishKind::Beat,
        }
    }
}

impl WishDraft {
    /// A draft whose values suit a plate.
    #[must_use]
    pub fn of(plate: &Plate) -> Self {
        let (start_m, end_m) = plate.span_m();
        let length_m = plate.length_m();
        let (middle_m, late_m) = (0.5 * (start_m + end_m), start_m + 0.75 * (end_m - start_m));
        let stripes_m = slipline_plate::texture::stripes_m(plate, plate.frequency_for_boundary_hz(middle_m));
        let (low_hz, high_hz) = plate.band_hz();
        Self {
            kind: WishKind::default(),
            felt_edge_m: late_m,
            profile: vec![(0.0, 1.0), (middle_m, 1.0), (late_m, 0.0), (length_m, 0.0)],
            level_m: None,
            stripes_m: stripes_m.unwrap_or(0.1 * length_m),
            beat_place_m: plate.airy_peak_m(0.5 * (low_hz + high_hz)).unwrap_or(middle_m),
            beat_hz: rounded(BEAT_HZ.min(BEAT_SHARE * (high_hz - low_hz))),
            most: TONES_MAX,
        }
    }

    /// The wanted texture.
    #[must_use]
    pub fn wish(&self) -> Wish {
        match self.kind {
            WishKind::Solid => Wish::Solid(self.felt_edge_m),
            WishKind::Profile => Wish::Profile(self.profile.clone()),
            WishKind::Stripes => Wish::Stripes(self.stripes_m),
            WishKind::Beat => Wish::Beat { place_m: self.beat_place_m, beat_hz: self.beat_hz },
        }
    }

    /// This draft with the end of its area where the refusal of another end allows it; `None` for any other refusal. Where a
    /// finger feels an area end depends on the plate's table, which a new draft does not know.
    #[must_use]
    pub fn suited(&self, refused: &TextureError) -> Option<Self> {
        let TextureError::OutOfRange(OutOfRange { range, field: "felt edge", .. }) = *refused else {
            return None;
        };
        let middle_m = 1e-3 * (500.0 * (range.low + range.high)).round();
        (self.kind == WishKind::Solid && range.contains(middle_m))
            .then(|| Self { felt_edge_m: middle_m, ..self.clone() })
    }

    /// Moves a breakpoint; it stays between its neighbours, on the plate, and its amplitude within 0..=1.
    pub fn move_breakpoint(&mut self, number: usize, (place_m, amplitude): (f64, f64), length_m: f64) {
        let before_m = number.checked_sub(1).and_then(|i| self.profile.get(i)).map(|point| point.0 + APART_M);
        let after_m = self.profile.get(number + 1).map(|point| point.0 - APART_M);
        let (low_m, high_m) = (before_m.unwrap_or(0.0), after_m.unwrap_or(length_m));
        if let Some(point) =
            self.profile.get_mut(number).filter(|_| place_m.is_finite() && amplitude.is_finite())
        {
            // Between neighbours at the smallest distance it keeps its place.
            let place_m = if low_m <= high_m { place_m.clamp(low_m, high_m) } else { point.0 };
            *point = (place_m, amplitude.clamp(0.0, 1.0));
        }
    }

    /// Adds a breakpoint; returns its number. `None` if there is no room for more, or one exists at this
    /// place.
    pub fn add_breakpoint(&mut self, (place_m, amplitude): (f64, f64), length_m: f64) -> Option<usize> {
        let is_near = |point: &(f64, f64)| (point.0 - place_m).abs() < APART_M;
        let is_refused = !(0.0..=length_m).contains(&place_m) || !amplitude.is_finite();
        if is_refused || self.profile.len() >= BREAKPOINTS_DRAWN_MAX || self.profile.iter().any(is_near) {
            return None;
        }
        let number = self.profile.partition_point(|point| point.0 < place_m);
        self.profile.insert(number, (place_m, amplitude.clamp(0.0, 1.0)));
        Some(number)
    }

    /// Removes a breakpoint; the last two cannot be removed.
    pub fn remove_breakpoint(&mut self, number: usize) {
        if self.profile.len() > BREAKPOINTS_MIN && number < self.profile.len() {
            self.profile.remove(number);
        }
    }

    /// Uses a profile from a file; its largest amplitude becomes 1.
    pub fn take_profile(&mut self, breakpoints: &[(f64, f64)]) {
        let largest = breakpoints.iter().map(|&(_, amplitude)| amplitude).fold(0.0, f64::max);
        let scale = if largest > 0.0 { largest.recip() } else { 1.0 };
        (self.kind, self.level_m) = (WishKind::Profile, None);
        self.profile = breakpoints.iter().map(|&(x_m, amplitude)| (x_m, amplitude * scale)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::SCENES;
    use crate::texture::making::make;
    use slipline_plate::feeling::Feeling;
    use slipline_plate::texture::Palette;
    use slipline_plate::{DriveTable, Progress};
    use std::sync::Arc;

    #[test]
    fn breakpoints_stay_in_order_and_on_the_plate() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let (mut draft, length_m) = (WishDraft::of(&plate), plate.length_m());
        draft.profile = vec![(0.0, 1.0), (0.1, 0.5), (0.3, 0.0)];
        draft.move_breakpoint(1, (0.5, 2.0), length_m);
        assert_eq!(draft.profile[1], (0.299, 1.0));
        draft.move_breakpoint(1, (-1.0, -1.0), length_m);
        assert_eq!(draft.profile[1], (0.001, 0.0));
        draft.move_breakpoint(2, (9.0, 0.2), length_m);
        assert_eq!(draft.profile[2], (length_m, 0.2));
        draft.move_breakpoint(1, (f64::NAN, 0.3), length_m);
        draft.move_breakpoint(7, (0.1, 0.3), length_m);
        assert_eq!(draft.profile[1], (0.001, 0.0));
        assert_eq!(draft.add_breakpoint((0.2, 1.5), length_m), Some(2));
        assert_eq!(draft.profile[2], (0.2, 1.0));
        for refused in [(0.2005, 0.1), (-0.1, 0.1), (f64::NAN, 0.1), (0.15, f64::NAN)] {
            assert_eq!(draft.add_breakpoint(refused, length_m), None, "{refused:?}");
        }
        for _ in 0..5 {
            draft.remove_breakpoint(0);
        }
        assert_eq!(draft.profile.len(), BREAKPOINTS_MIN);
        while draft.add_breakpoint((0.01 + 0.005 * draft.profile.len() as f64, 0.5), length_m).is_some() {}
        assert_eq!(draft.profile.len(), BREAKPOINTS_DRAWN_MAX);
    }

    #[test]
    fn a_profile_of_any_unit_is_drawn_up_to_one() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let mut draft = WishDraft { kind: WishKind::Beat, ..WishDraft::of(&plate) };
        draft.take_profile(&[(0.0, 20.0), (0.2, 5.0)]);
        assert_eq!((draft.kind, &draft.profile[..]), (WishKind::Profile, &[(0.0, 1.0), (0.2, 0.25)][..]));
    }

    #[test]
    fn every_kind_of_a_new_draft_can_be_made_on_every_plate_that_is_shipped() {
        let presets = slipline_plate::presets().iter().filter_map(|preset| preset.plate()).map(Arc::new);
        let scenes = SCENES.iter().filter_map(|scene| Some(scene.setup()?.plate));
        for plate in presets.chain(scenes) {
            let table = DriveTable::build(&plate, 400e3, 65).unwrap();
            let palette = Palette::new(&plate, &table);
            for kind in WishKind::ALL {
                let draft = WishDraft { kind, most: 2, ..WishDraft::of(&plate) };
                let mut go_on = |_| true;
                let progress = &mut Progress::new(&mut go_on);
                let mut made = |draft: &WishDraft| {
                    make(&palette, &draft.wish(), draft.most, &Feeling::default(), progress)
                };
                if let Err(refused) = made(&draft) {
                    // The paper's plate as it was printed moves by too little to be felt at all.
                    if plate.name() == "paper-as-printed" && kind == WishKind::Solid {
                        assert!(refused.to_string().starts_with("nothing is felt"), "{refused}");
                        continue;
                    }
                    let suited =
                        draft.suited(&refused).unwrap_or_else(|| panic!("{}: {refused}", plate.name()));
                    let made = made(&suited);
                    assert!(made.is_ok(), "{} {kind:?}: {}", plate.name(), made.unwrap_err());
                }
            }
        }
    }

    #[test]
    fn a_beat_of_more_than_the_band_is_refused_with_a_range_that_rises() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let table = DriveTable::build(&plate, 400e3, 65).unwrap();
        let palette = Palette::new(&plate, &table);
        let draft = WishDraft { kind: WishKind::Beat, beat_hz: 300.0, ..WishDraft::of(&plate) };
        let mut go_on = |_| true;
        let progress = &mut Progress::new(&mut go_on);
        let refused = make(&palette, &draft.wish(), 2, &Feeling::default(), progress).unwrap_err();
        let TextureError::OutOfRange(error) = refused else { panic!("{refused}") };
        assert!(error.field == "beat frequency" && error.range.low < error.range.high, "{error}");
        assert!(error.range.high < 140.0, "{error}");
    }
}
