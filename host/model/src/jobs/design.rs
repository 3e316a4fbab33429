//! The plate designer in the app: the user's draft and the plate designed from it. The rules are those of
//! `slipline design`.

use crate::jobs::Task;
use slipline_plate::design::{Design, DesignError, Edge, Material, Request, Wave, design};
use slipline_plate::{PlateError, Progress};
use std::sync::Arc;

/// The type of wave and edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Kind {
    /// Bending, edges simply supported.
    Supported,
    /// Bending, edges clamped in a stiff frame.
    Clamped,
    /// A stretched membrane.
    Membrane,
    /// The shear-horizontal wave.
    Shear,
}

impl Kind {
    /// Every kind, in the order of the menu.
    pub const ALL: [Self; 4] = [Self::Supported, Self::Clamped, Self::Membrane, Self::Shear];

    /// Its name in the menu.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Supported => "Bending, supported",
            Self::Clamped => "Bending, clamped",
            Self::Membrane => "Stretched membrane",
            Self::Shear => "Shear-horizontal",
        }
    }
}

/// Definition of a membrane's stretch.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Stretch {
    /// Wave speed in m/s.
    WaveSpeed(f64),
    /// Tension in N per metre of width.
    Tension(f64),
}

/// The requirements of a plate. `None` selects the library's value.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Draft {
    /// The plate's name.
    pub name: String,
    /// The library's name of the sheet's material.
    #[serde(with = "slipline_plate::static_text")]
    pub material: slipline_plate::StaticText,
    /// The sheet's thickness in metres.
    pub thickness_m: f64,
    /// Its type of wave and edges.
    pub kind: Kind,
    /// Whether a bending plate is without shear and rotary inertia.
    pub thin: bool,
    /// A membrane's stretch.
    pub stretch: Stretch,
    /// The boundary's lowest and highest frequency in Hz.
    pub band_hz: (f64, f64),
    /// Distance from the driven end to the narrow end, in metres.
    pub length_m: f64,
    /// Distance from the driven end to the nearest boundary, in metres.
    pub start_margin_m: Option<f64>,
    /// Distance from the farthest boundary to the narrow end, in metres.
    pub end_margin_m: Option<f64>,
    /// Loss factor.
    pub loss_factor: Option<f64>,
    /// The drive's displacement at DAC full scale, in metres.
    pub full_scale_m: Option<f64>,
    /// Width of the frame's rim, in metres.
    pub rim_m: f64,
}

impl Default for Draft {
    /// The aluminium plate of `slipline design --help`.
    fn default() -> Self {
        Self {
            name: "designed".to_owned(),
            material: "aluminium",
            thickness_m: 2e-3,
            kind: Kind::Supported,
            thin: false,
            stretch: Stretch::WaveSpeed(12.0),
            band_hz: (20e3, 40e3),
            length_m: 0.3,
            start_margin_m: None,
            end_margin_m: None,
            loss_factor: None,
            full_scale_m: None,
            rim_m: 0.02,
        }
    }
}

/// Young's modulus below which a sheet is a membrane, in Pa: rubber bends under its own weight.
const SOFT_PA: f64 = 1e8;

impl Draft {
    /// The draft of another material. Where that is stiff and this is soft, or the other way round, thickness, wave, band and
    /// length follow: a rubber sheet is stretched and felt as vibration, a plate of metal bends and is slippery.
    #[must_use]
    pub fn of_material(self, name: slipline_plate::StaticText) -> Self {
        let is_soft =
            |name: &str| Material::named(name).is_ok_and(|material| material.youngs_modulus_pa < SOFT_PA);
        let draft = Self { material: name, loss_factor: None, ..self };
        match (is_soft(draft.material), draft.kind == Kind::Membrane) {
            (true, false) => Self {
                thickness_m: 0.5e-3,
                kind: Kind::Membrane,
                stretch: Stretch::WaveSpeed(12.0),
                band_hz: (80.0, 220.0),
                length_m: 0.4,
                start_margin_m: None,
                end_margin_m: None,
                full_scale_m: None,
                ..draft
            },
            (false, true) => {
                let stiff = Self::default();
                Self {
                    name: draft.name,
                    material: draft.material,
                    thin: draft.thin,
                    rim_m: draft.rim_m,
                    ..stiff
                }
            }
            (true, true) | (false, false) => draft,
        }
    }

    /// The draft as a request to the plate library.
    ///
    /// # Errors
    /// [`PlateError`] if the library has no such material.
    pub fn request(&self) -> Result<Request, PlateError> {
        let mut material = Material::named(self.material)?;
        if let Some(loss_factor) = self.loss_factor {
            material.loss_factor = loss_factor;
        }
        let thick_plate = !self.thin;
        let wave = match self.kind {
            Kind::Supported => Wave::Bending { edge: Edge::Supported, thick_plate },
            Kind::Clamped => Wave::Bending { edge: Edge::Clamped, thick_plate },
            Kind::Shear => Wave::ShearHorizontal,
            Kind::Membrane => match self.stretch {
                Stretch::WaveSpeed(wave_speed_m_per_s) => Wave::Membrane { wave_speed_m_per_s },
                Stretch::Tension(tension) => Wave::under_tension(tension, &material, self.thickness_m),
            },
        };
        let mut request =
            Request::new(&self.name, material, self.thickness_m, wave, self.band_hz, self.length_m);
        request.start_margin_m = self.start_margin_m;
        request.end_margin_m = self.end_margin_m;
        request.rim_m = self.rim_m;
        if let Some(full_scale_m) = self.full_scale_m {
            request.full_scale_m = full_scale_m;
        }
        Ok(request)
    }
}

/// The result of a draft.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Designed {
    /// The draft.
    pub draft: Draft,
    /// The plate, or why none was found.
    pub result: Result<Arc<Design>, PlateError>,
}

/// Designs the plate; `None` if the task was cancelled.
#[must_use]
pub fn work(draft: Draft, task: &Task) -> Option<Designed> {
    if task.is_over() {
        return None;
    }
    designed(draft, &mut Progress::new(&mut |share| task.report(share)))
}

fn designed(draft: Draft, progress: &mut Progress<'_>) -> Option<Designed> {
    let result = match draft.request().map(|request| design(&request, progress)) {
        Ok(Ok(design)) => Ok(Arc::new(design)),
        Err(error) | Ok(Err(DesignError::Plate(error))) => Err(error),
        Ok(Err(DesignError::Stopped(_))) => return None,
    };
    Some(Designed { draft, result })
}

/// The cut files of plate and frame: their names and texts.
#[must_use]
pub fn cut_files(designed: &Design) -> Vec<(String, String)> {
    let (plate, frame) = (designed.plate_drawing(), designed.frame_drawing());
    [
        ("plate.svg", plate.to_svg()),
        ("plate.dxf", plate.to_dxf()),
        ("frame.svg", frame.to_svg()),
        ("frame.dxf", frame.to_dxf()),
    ]
    .map(|(name, text)| (name.to_owned(), text))
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_design_that_is_cancelled_while_it_runs_has_no_result() {
        let task = Task::default();
        assert!(work(Draft::default(), &task).is_some());
        assert!(task.share() > 0.99, "{}", task.share());
        for limit in [0.0, 0.3, 1.0] {
            let mut go_on = |share: f64| {
                if share >= limit {
                    task.end();
                }
                task.report(share)
            };
            assert!(designed(Draft::default(), &mut Progress::new(&mut go_on)).is_none(), "{limit}");
        }
        assert!(work(Draft::default(), &task).is_none());
    }

    #[test]
    fn wave_and_band_follow_the_material_and_every_material_has_a_plate() {
        for name in slipline_plate::design::material_names() {
            let draft = Draft::default().of_material(name);
            let is_rubber = matches!(name, "latex" | "silicone-rubber");
            assert_eq!(draft.kind == Kind::Membrane, is_rubber, "{name}");
            assert_eq!(draft.band_hz.1 < 1e3, is_rubber, "{name}");
            let back = draft.clone().of_material("aluminium");
            assert_eq!(back, Draft::default(), "{name}");
            let designed = work(draft, &Task::default()).unwrap().result;
            assert!(designed.is_ok(), "{name}: {designed:?}");
        }
        // What the user has chosen stays while it suits.
        let clamped = Draft { kind: Kind::Clamped, length_m: 0.25, ..Draft::default() };
        assert_eq!(clamped.clone().of_material("steel"), Draft { material: "steel", ..clamped });
    }

    #[test]
    fn a_draft_is_designed_as_the_command_line_does_it() {
        let designed = work(Draft::default(), &Task::default()).unwrap().result.unwrap();
        let (low, high) = designed.plate.band_hz();
        assert!((low - 20e3).abs() < 1e-2 && (high - 40e3).abs() < 1e-2, "{low} {high}");
        assert_eq!(cut_files(&designed).len(), 4);
        // 68.4 N/m over 950 kg/m^3 x 0.5 mm is (12 m/s)^2.
        let membrane = |stretch| Draft {
            material: "latex",
            thickness_m: 5e-4,
            kind: Kind::Membrane,
            stretch,
            band_hz: (80.0, 220.0),
            length_m: 0.4,
            ..Draft::default()
        };
        let by_tension = membrane(Stretch::Tension(68.4)).request().unwrap();
        let Wave::Membrane { wave_speed_m_per_s } = by_tension.wave else { panic!("no membrane") };
        assert!((wave_speed_m_per_s - 12.0).abs() < 1e-9);
        assert_eq!(by_tension.full_scale_m, 1e-4);
    }

    #[test]
    fn a_bad_value_is_named_by_its_field() {
        let refusal = |change: fn(&mut Draft)| {
            let mut draft = Draft::default();
            change(&mut draft);
            work(draft, &Task::default()).unwrap().result.unwrap_err()
        };
        assert_eq!(refusal(|draft| draft.thickness_m = 5.0).field(), "thickness_m");
        assert_eq!(refusal(|draft| draft.band_hz.1 = 20e3).field(), "band high");
        assert_eq!(refusal(|draft| draft.loss_factor = Some(f64::NAN)).field(), "material.loss_factor");
        assert_eq!(refusal(|draft| draft.start_margin_m = Some(1.0)).field(), "start_margin_m");
        assert!(refusal(|draft| draft.length_m = 0.01).to_string().contains("longer"));
    }
}
