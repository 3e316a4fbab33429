//! The fields of the plate itself: its length, loss and span, its taper, its model and its thickness.

use super::field::{At, Columns, Field, FieldType, Kind, NONE, NOWHERE, Section, Slot, fields, kinds};
use crate::definition::film::Film;
use crate::definition::limits;
use crate::definition::model::{Bending, Model};
use crate::definition::taper::Taper;
use crate::definition::thickness::Thickness;
use crate::definition::turning_width::TurningWidth;
use crate::quantity::{Caption, Unit};

const MM: Unit = Unit::Millimetre;

const PLACES: Columns = Columns {
    points: limits::TAPER_POINTS,
    one: "a pair [place, half-width] of numbers, in m",
    many: "pairs [place, half-width] of numbers, in m",
};
const THICKNESSES: Columns = Columns {
    points: limits::TAPER_POINTS,
    one: "a pair [place, thickness] of numbers, in m",
    many: "pairs [place, thickness] of numbers, in m",
};

const TURNING_WIDTHS: &[&str] = &[TurningWidth::ALL[0].word(), TurningWidth::ALL[1].word()];

/// In the order of a written file, which states the span.
const WRITTEN: &[&str] = &[
    "name",
    "description",
    "length_m",
    "loss_factor",
    "wave_speed_tolerance",
    "loss_tolerance",
    "loss_exponent",
    "loss_exponent_tolerance",
    "edge_give_m",
    "edge_give_tolerance_m",
    "tension_ratio",
    "tension_ratio_tolerance",
    "turning_width",
    "full_scale_m",
    "span_start_m",
    "span_end_m",
];

pub(crate) const PLATE: Section = Section {
    name: "",
    meaning: "",
    kind_field: "",
    kinds: &[Kind { word: "", fields: WRITTEN, is: |_| true, begin: |_, _| {} }],
    not_a_kind: NONE,
    fields: fields! { spec:
        name: FieldType::Text(limits::NAME), "the plate's short name"
            { spec.name, it => Slot::Text(it) };
        description: FieldType::Text(limits::DESCRIPTION), "one line that says what the plate is"
            { spec.description, it => Slot::Text(it) };
        length_m: FieldType::Number(limits::LENGTH), "from the driven end to the narrow end" ["Length", MM]
            { spec.length_m, it => Slot::Number(it) };
        loss_factor: FieldType::Number(limits::LOSS_FACTOR), "loss factor of the modulus or the tension"
            ["Loss factor", Unit::Pure]
            { spec.loss_factor, it => Slot::Number(it) };
        wave_speed_tolerance: FieldType::Number(limits::WAVE_SPEED_TOLERANCE), "how well the wave speed is known"
            (or 0.0)
            { spec.wave_speed_tolerance, it => Slot::Number(it) };
        edge_give_m: FieldType::Number(limits::EDGE_GIVE), "how far the edges give beyond the cut" ["Edges give", MM]
            (or 0.0)
            { spec.edge_give_m, it => Slot::Optional(it) };
        edge_give_tolerance_m: FieldType::Number(limits::EDGE_GIVE_TOLERANCE), "how well that is known"
            { spec.edge_give_tolerance_m, it => Slot::Optional(it) };
        tension_ratio: FieldType::Number(limits::TENSION_RATIO), "tension across over tension along a membrane"
            ["Tension ratio", Unit::Pure] (or 1.0)
            { spec.tension_ratio, it => Slot::Optional(it) };
        tension_ratio_tolerance: FieldType::Number(limits::TENSION_RATIO_TOLERANCE), "how well that is known"
            { spec.tension_ratio_tolerance, it => Slot::Optional(it) };
        turning_width: FieldType::OneOf(TURNING_WIDTHS), "the width that decides where a wave turns"
            { spec.turning_width, it => Slot::Width(it) };
        loss_tolerance: FieldType::Number(limits::LOSS_TOLERANCE), "how well the loss factor is known"
            { spec.loss_tolerance, it => Slot::Optional(it) };
        loss_exponent: FieldType::Number(limits::LOSS_EXPONENT), "exponent of the loss factor over the frequency"
            ["Loss exponent", Unit::Pure] (or 0.0)
            { spec.loss_exponent, it => Slot::Optional(it) };
        loss_exponent_tolerance: FieldType::Number(limits::LOSS_EXPONENT_TOLERANCE), "how well that is known"
            { spec.loss_exponent_tolerance, it => Slot::Optional(it) };
        full_scale_m: FieldType::Number(limits::FULL_SCALE), "the drive's displacement at DAC full scale"
            ["At full scale", MM] (or 1e-6)
            { spec.full_scale_m, it => Slot::Number(it) };
        // Where the file states the band, the span follows from it.
        span_start_m: FieldType::NumberThat("above 0, in m"), "the nearest turning point that is offered"
            ["Span from", MM] (or 0.0)
            { spec.span_start_m, it => Slot::Number(it) };
        span_end_m: FieldType::NumberThat("up to length_m, in m"), "the farthest turning point that is offered"
            ["Span to", MM] (or 0.0)
            { spec.span_end_m, it => Slot::Number(it) };
        band_start_hz: FieldType::NumberThat("in Hz, so high that it enters the plate"), "the lowest frequency";
        band_end_hz: FieldType::NumberThat("in Hz, so low that it turns on the plate"), "the highest frequency";
    },
};

pub(crate) const TAPER: Section = Section {
    name: "taper",
    meaning: "how the half-width narrows",
    kind_field: "kind",
    kinds: kinds! { spec, has:
        "exponential" [half_width_m rate_per_m] { spec.taper, Taper::Exponential { .. } }
            = Taper::Exponential { half_width_m: 0.0, rate_per_m: 0.0 };
        "linear" [half_width_m end_half_width_m] { spec.taper, Taper::Linear { .. } }
            = Taper::Linear { half_width_m: 0.0, end_half_width_m: 0.0 };
        "sampled" [points] { spec.taper, Taper::Sampled { .. } } = Taper::Sampled { points: Vec::new() };
    },
    not_a_kind: NONE,
    fields: fields! { spec:
        kind: FieldType::Kind, "the law of the half-width";
        half_width_m: FieldType::Number(limits::HALF_WIDTH), "half-width at the driven end" ["Half-width", MM]
            { spec.taper, Taper::Exponential { half_width_m: it, .. } | Taper::Linear { half_width_m: it, .. }
                => Slot::Number(it) };
        rate_per_m: FieldType::Number(limits::TAPER_RATE), "how fast the half-width falls"
            ["Taper rate", Unit::Times("1/m", 1.0)]
            { spec.taper, Taper::Exponential { rate_per_m: it, .. } => Slot::Number(it) };
        end_half_width_m: FieldType::NumberThat("1e-5 m to 0.999 half_width_m"), "half-width at the narrow end"
            ["End half-width", MM]
            { spec.taper, Taper::Linear { end_half_width_m: it, .. } => Slot::Number(it) };
        points: FieldType::Points(&PLACES), "places with their half-widths" ["The file's half-widths", MM]
            { spec.taper, Taper::Sampled { points: it } => Slot::Pairs(it) };
    },
};

const NO_BENDING: Bending = Bending {
    youngs_modulus_pa: 0.0,
    poisson_ratio: 0.0,
    density_kg_per_m3: 0.0,
    thickness_m: 0.0,
    thick_plate: false,
};

/// The film of a membrane, whose three fields belong together.
fn film(has: &dyn Fn(&str) -> bool) -> Option<Film> {
    let is_stated = ["youngs_modulus_pa", "poisson_ratio", "thickness_m"].into_iter().any(has);
    is_stated.then_some(Film { youngs_modulus_pa: 0.0, poisson_ratio: 0.0, thickness_m: 0.0 })
}

pub(crate) const MODEL: Section = Section {
    name: "model",
    meaning: "material, edge and wave",
    kind_field: "kind",
    kinds: kinds! { spec, has:
        "membrane" [wave_speed_m_per_s tension_n_per_m youngs_modulus_pa poisson_ratio thickness_m]
            { spec.model, Model::Membrane { .. } }
            = Model::Membrane { wave_speed_m_per_s: 0.0, tension_n_per_m: None, film: film(has) };
        "shear-horizontal" [shear_modulus_pa density_kg_per_m3 thickness_m]
            { spec.model, Model::ShearHorizontal { .. } }
            = Model::ShearHorizontal { shear_modulus_pa: 0.0, density_kg_per_m3: 0.0, thickness_m: None };
        "bending-supported" [youngs_modulus_pa poisson_ratio density_kg_per_m3 thickness_m thick_plate]
            { spec.model, Model::BendingSupported(_) } = Model::BendingSupported(NO_BENDING);
        "bending-clamped" [youngs_modulus_pa poisson_ratio density_kg_per_m3 thickness_m thick_plate]
            { spec.model, Model::BendingClamped(_) } = Model::BendingClamped(NO_BENDING);
    },
    not_a_kind: NONE,
    fields: fields! { spec:
        kind: FieldType::Kind, "the wave and the edge";
        wave_speed_m_per_s: FieldType::Number(limits::WAVE_SPEED), "wave speed of the membrane"
            ["Wave speed", Unit::Times("m/s", 1.0)]
            { spec.model, Model::Membrane { wave_speed_m_per_s: it, .. } => Slot::Number(it) };
        tension_n_per_m: FieldType::Number(limits::TENSION), "tension per metre of width"
            ["Tension", Unit::Times("N/m", 1.0)]
            { spec.model, Model::Membrane { tension_n_per_m: it, .. } => Slot::Optional(it) };
        shear_modulus_pa: FieldType::Number(limits::SHEAR_MODULUS), "shear modulus"
            ["Shear modulus", Unit::Times("MPa", 1e6)]
            { spec.model, Model::ShearHorizontal { shear_modulus_pa: it, .. } => Slot::Number(it) };
        youngs_modulus_pa: FieldType::Number(limits::YOUNGS_MODULUS), "Young's modulus"
            ["Young's modulus", Unit::Times("GPa", 1e9)]
            { spec.model, Model::Membrane { film: Some(Film { youngs_modulus_pa: it, .. }), .. }
                | Model::BendingSupported(Bending { youngs_modulus_pa: it, .. })
                | Model::BendingClamped(Bending { youngs_modulus_pa: it, .. }) => Slot::Number(it) };
        poisson_ratio: FieldType::Number(limits::POISSON_RATIO), "Poisson's ratio" ["Poisson's ratio", Unit::Pure]
            { spec.model, Model::Membrane { film: Some(Film { poisson_ratio: it, .. }), .. }
                | Model::BendingSupported(Bending { poisson_ratio: it, .. })
                | Model::BendingClamped(Bending { poisson_ratio: it, .. }) => Slot::Number(it) };
        density_kg_per_m3: FieldType::Number(limits::DENSITY), "density" ["Density", Unit::Times("kg/m³", 1.0)]
            { spec.model, Model::ShearHorizontal { density_kg_per_m3: it, .. }
                | Model::BendingSupported(Bending { density_kg_per_m3: it, .. })
                | Model::BendingClamped(Bending { density_kg_per_m3: it, .. }) => Slot::Number(it) };
        thickness_m: FieldType::Number(limits::THICKNESS), "thickness of the sheet" ["Thickness", MM]
            { spec.model, Model::ShearHorizontal { thickness_m: it, .. } => Slot::Optional(it),
                Model::Membrane { film: Some(Film { thickness_m: it, .. }), .. }
                | Model::BendingSupported(Bending { thickness_m: it, .. })
                | Model::BendingClamped(Bending { thickness_m: it, .. }) => Slot::Number(it) };
        thick_plate: FieldType::Flag, "Mindlin's correction"
            { spec.model, Model::BendingSupported(Bending { thick_plate: it, .. })
                | Model::BendingClamped(Bending { thick_plate: it, .. }) => Slot::Flag(it) };
    },
};

pub(super) const THICKNESS: Section = Section {
    name: "thickness",
    meaning: "how the thickness of a plate in bending changes along it",
    kind_field: "kind",
    kinds: kinds! { spec, has:
        "exponential" [rate_per_m] { spec.thickness, Some(Thickness::Exponential { .. }) }
            = Some(Thickness::Exponential { rate_per_m: 0.0 });
        "linear" [end_thickness_m] { spec.thickness, Some(Thickness::Linear { .. }) }
            = Some(Thickness::Linear { end_thickness_m: 0.0 });
        "sampled" [points] { spec.thickness, Some(Thickness::Sampled { .. }) }
            = Some(Thickness::Sampled { points: Vec::new() });
    },
    not_a_kind: NONE,
    fields: fields! { spec:
        kind: FieldType::Kind, "the law of the thickness";
        rate_per_m: FieldType::Number(limits::THICKNESS_RATE), "how fast the thickness falls"
            { spec.thickness, Some(Thickness::Exponential { rate_per_m: it }) => Slot::Number(it) };
        end_thickness_m: FieldType::Number(limits::THICKNESS), "thickness at the narrow end"
            { spec.thickness, Some(Thickness::Linear { end_thickness_m: it }) => Slot::Number(it) };
        points: FieldType::Points(&THICKNESSES), "places with their thicknesses"
            { spec.thickness, Some(Thickness::Sampled { points: it }) => Slot::Pairs(it) };
    },
};
