//! `slipline.design`.

use crate::arguments::pair;
use crate::error::Failure;
use crate::options::Options;
use crate::plate::Plate;
use crate::result::{Answer, fields};
use crate::waiting::compute;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slipline_model::answer::design::{DesignAnswer, design as compute_design};
use slipline_plate::design::{Edge, Material, Request, Wave, end_margin_range, start_margin_range};
use slipline_plate::quantity::OutOfRange;
use slipline_plate::{Air, AirMounting, Faces, Gas, limits};

/// A plate for a material and a band, as ``slipline design``.
///
/// ``material`` is one of aluminium, steel, stainless-steel, brass, glass, fr4, acrylic, polycarbonate, polyester-film,
/// silicone-rubber and latex; ``thickness_m`` is 1e-6 to 0.1, ``band_hz`` the lowest and the highest frequency of the tones,
/// ``length_m`` 0.005 to 10. Options: one of ``edge`` (``"supported"`` or ``"clamped"``), ``wave_speed`` (m/s), ``tension`` (N/m)
/// and ``shear``; ``air`` (``"bare-frame"``, ``"baffle"`` or ``"vacuum"``), ``thin``, ``start_margin`` and ``end_margin`` (metres),
/// ``loss``, ``full_scale`` and ``rim`` (metres), ``name``.
///
/// ``.plate`` is the plate; ``.check`` has its lights.
///
/// Raises ``OutOfRange`` and ``Refused``.
#[pyfunction]
#[pyo3(signature = (material, thickness_m, band_hz, length_m, **as_cli))]
pub(crate) fn design(
    py: Python<'_>,
    material: &str,
    thickness_m: f64,
    band_hz: &Bound<'_, PyAny>,
    length_m: f64,
    as_cli: Option<&Bound<'_, PyDict>>,
) -> PyResult<Answer> {
    let band_hz = pair("band_hz", band_hz, "the lowest and the highest frequency, Hz")?;
    let material = Material::named(material).map_err(|error| Failure::of(&error))?;
    let request = request(material, thickness_m, band_hz, length_m, Options::new("design", as_cli)?)?;
    let (found, plate) = compute(py, move |progress| {
        let (designed, lights) = compute_design(&request, progress).map_err(|error| Failure::of(&error))?;
        let found = fields(&DesignAnswer::of(&designed, &lights));
        Ok((found, designed.plate))
    })?;
    Answer::of(py, found)?.with(py, "plate", Plate::from(plate))
}

fn request(
    mut material: Material,
    thickness_m: f64,
    band_hz: (f64, f64),
    length_m: f64,
    mut options: Options<'_>,
) -> PyResult<Request> {
    for (field, value, range) in
        [("thickness_m", thickness_m, limits::THICKNESS), ("length_m", length_m, limits::LENGTH)]
    {
        OutOfRange::check(field, value, range).map_err(|refused| Failure::out_of_range(&refused))?;
    }
    let edge = options.word("edge", &[("supported", Edge::Supported), ("clamped", Edge::Clamped)])?;
    let wave_speed_m_per_s = options.number("wave_speed", limits::WAVE_SPEED)?;
    let tension = options.number("tension", Wave::tensions(&material, thickness_m))?;
    let is_shear = options.switch("shear")?;
    let thick_plate = !options.switch("thin")?;
    let baffle = Air::Around { gas: Gas::ROOM, mounting: AirMounting::Baffle { faces: Faces::Two } };
    let air = [("bare-frame", Air::ROOM), ("baffle", baffle), ("vacuum", Air::Vacuum)];
    let air = options.word("air", &air)?;
    if let Some(loss_factor) = options.number("loss", limits::LOSS_FACTOR)? {
        material.loss_factor = loss_factor;
    }
    let wave = match (edge, wave_speed_m_per_s, tension, is_shear) {
        (edge, None, None, false) => Wave::Bending { edge: edge.unwrap_or(Edge::Supported), thick_plate },
        (None, Some(wave_speed_m_per_s), None, false) => Wave::Membrane { wave_speed_m_per_s },
        (None, None, Some(tension), false) => Wave::under_tension(tension, &material, thickness_m),
        (None, None, None, true) if air.is_none() => Wave::ShearHorizontal,
        (None, None, None, true) => {
            return Err(
                Failure::wrong_arguments("air beside shear", "left out: the wave moves no air").into()
            );
        }
        _ => {
            let given = "more than one wave";
            return Err(Failure::wrong_arguments(given, "one of edge, wave_speed, tension and shear").into());
        }
    };
    let name = options.text("name")?.unwrap_or_else(|| "designed".to_owned());
    let mut request = Request::new(&name, material, thickness_m, wave, band_hz, length_m);
    request.start_margin_m = options.number("start_margin", start_margin_range(length_m))?;
    request.end_margin_m = options.number("end_margin", end_margin_range(length_m))?;
    if let Some(rim_m) = options.number("rim", limits::RIM)? {
        request.rim_m = rim_m;
    }
    if let Some(full_scale_m) = options.number("full_scale", limits::FULL_SCALE)? {
        request.full_scale_m = full_scale_m;
    }
    if let Some(air) = air {
        request.air = Some(air);
    }
    options.end()?;
    Ok(request)
}
