//! `slipline.design`.

use crate::arguments::{in_range, one_of, optional, pair};
use crate::error::Failure;
use crate::plate::Plate;
use crate::result::kind::Design;
use crate::result::{Answer, fields};
use crate::waiting::compute;
use pyo3::prelude::*;
use slipline_model::answer::design::{DesignAnswer, design as compute_design};
use slipline_plate::design::{Edge, Material, Request, Wave, end_margin_range, start_margin_range};
use slipline_plate::{Air, AirMounting, Faces, Gas, limits};

/// A plate for a material and a band, as ``slipline design``.
///
/// ``material`` is one of aluminium, steel, stainless-steel, brass, glass, fr4, acrylic, polycarbonate, polyester-film,
/// silicone-rubber and latex; ``thickness_m`` is 1e-6 to 0.1, ``band_hz`` the lowest and the highest frequency of the tones,
/// ``length_m`` 0.005 to 10. The wave is named by one of ``edge`` (``"supported"`` or ``"clamped"``), ``wave_speed_m_per_s``,
/// ``tension_n_per_m`` and ``shear``; ``air`` is ``"bare-frame"``, ``"baffle"`` or ``"vacuum"``, and ``thin`` leaves out the
/// plate's thickness in its bending.
///
/// ``.plate`` is the plate; ``.check`` has its lights.
///
/// Raises ``OutOfRange`` and ``Refused``.
#[pyfunction]
#[pyo3(signature = (material, thickness_m, band_hz, length_m, *, edge=None, wave_speed_m_per_s=None, tension_n_per_m=None, shear=false, air=None, thin=false, start_margin_m=None, end_margin_m=None, loss_factor=None, full_scale_m=None, rim_m=None, name=None))]
#[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
pub(crate) fn design(
    py: Python<'_>,
    material: &str,
    thickness_m: f64,
    band_hz: &Bound<'_, PyAny>,
    length_m: f64,
    edge: Option<&str>,
    wave_speed_m_per_s: Option<f64>,
    tension_n_per_m: Option<f64>,
    shear: bool,
    air: Option<&str>,
    thin: bool,
    start_margin_m: Option<f64>,
    end_margin_m: Option<f64>,
    loss_factor: Option<f64>,
    full_scale_m: Option<f64>,
    rim_m: Option<f64>,
    name: Option<String>,
) -> PyResult<Answer<Design>> {
    let band_hz = pair("band_hz", band_hz, "the lowest and the highest frequency, Hz")?;
    let material = Material::named(material).map_err(|error| Failure::of(&error))?;
    for (field, value, range) in
        [("thickness_m", thickness_m, limits::THICKNESS), ("length_m", length_m, limits::LENGTH)]
    {
        in_range(field, value, range)?;
    }
    let mut material = material;
    optional("loss_factor", loss_factor, limits::LOSS_FACTOR)?;
    material.loss_factor = loss_factor.unwrap_or(material.loss_factor);
    let asked = AskedWave { edge, wave_speed_m_per_s, tension_n_per_m, shear, air, thin };
    let (wave, air) = asked.read(&material, thickness_m)?;
    let name = name.unwrap_or_else(|| "designed".to_owned());
    let mut request = Request::new(&name, material, thickness_m, wave, band_hz, length_m);
    optional("start_margin_m", start_margin_m, start_margin_range(length_m))?;
    optional("end_margin_m", end_margin_m, end_margin_range(length_m))?;
    optional("rim_m", rim_m, limits::RIM)?;
    optional("full_scale_m", full_scale_m, limits::FULL_SCALE)?;
    (request.start_margin_m, request.end_margin_m) = (start_margin_m, end_margin_m);
    request.rim_m = rim_m.unwrap_or(request.rim_m);
    request.full_scale_m = full_scale_m.unwrap_or(request.full_scale_m);
    request.air = air.or(request.air);
    let (found, plate) = compute(py, move |progress| {
        let (designed, lights) = compute_design(&request, progress).map_err(|error| Failure::of(&error))?;
        let found = fields(&DesignAnswer::of(&designed, &lights));
        Ok((found, designed.plate))
    })?;
    Answer::of(py, found)?.with(py, "plate", Plate::from(plate))
}

/// The wave and the air of the arguments.
struct AskedWave<'a> {
    edge: Option<&'a str>,
    wave_speed_m_per_s: Option<f64>,
    tension_n_per_m: Option<f64>,
    shear: bool,
    air: Option<&'a str>,
    thin: bool,
}

impl AskedWave<'_> {
    fn read(self, material: &Material, thickness_m: f64) -> Result<(Wave, Option<Air>), Failure> {
        let Self { edge, wave_speed_m_per_s, tension_n_per_m, shear, air, thin } = self;
        let edges = [("supported", Edge::Supported), ("clamped", Edge::Clamped)];
        let edge = edge.map(|word| one_of("edge", word, &edges)).transpose()?;
        optional("wave_speed_m_per_s", wave_speed_m_per_s, limits::WAVE_SPEED)?;
        optional("tension_n_per_m", tension_n_per_m, Wave::tensions(material, thickness_m))?;
        let thick_plate = !thin;
        let baffle =
            Air::Around { gas: Gas::ROOM, mounting: AirMounting::Baffle { faces: Faces::Two }, gap_m: None };
        let airs = [("bare-frame", Air::ROOM), ("baffle", baffle), ("vacuum", Air::Vacuum)];
        let air = air.map(|word| one_of("air", word, &airs)).transpose()?;
        let wave = match (edge, wave_speed_m_per_s, tension_n_per_m, shear) {
            (edge, None, None, false) => Wave::Bending { edge: edge.unwrap_or(Edge::Supported), thick_plate },
            (None, Some(wave_speed_m_per_s), None, false) => Wave::Membrane { wave_speed_m_per_s },
            (None, None, Some(tension), false) => Wave::under_tension(tension, material, thickness_m),
            (None, None, None, true) if air.is_none() => Wave::ShearHorizontal,
            (None, None, None, true) => {
                let allowed = "left out: the wave moves no air";
                return Err(Failure::wrong_arguments("air beside shear", allowed));
            }
            _ => {
                let allowed = "one of edge, wave_speed_m_per_s, tension_n_per_m and shear";
                return Err(Failure::wrong_arguments("more than one wave", allowed));
            }
        };
        Ok((wave, air))
    }
}
