//! The fields of what is around the plate: the driven end, the air, the frame, the actuator, and the record of a calibration.

use super::field::{At, Columns, Field, FieldType, Kind, NONE, NOWHERE, Section, Slot, fields, kinds};
use crate::definition::actuator::{Actuator, Resonator};
use crate::definition::air::{Air, AirMounting, Faces, Gas};
use crate::definition::calibration::{Calibration, SOURCE_TOLERANCE};
use crate::definition::drive::DriveEnd;
use crate::definition::frame::Frame;
use crate::definition::harmonics::Harmonics;
use crate::definition::impedance::Impedance;
use crate::definition::limits;
use crate::definition::response_curve::ResponseCurve;
use crate::definition::source::{EndSlope, LeadIn, Source};
use crate::definition::travel::Travel;
use crate::quantity::{Caption, Unit};

const MM: Unit = Unit::Millimetre;

const CURVE: Columns = Columns {
    points: limits::CURVE_POINTS,
    one: "a triple [frequency, gain, phase] of numbers, in Hz, dB and degrees",
    many: "triples [frequency, gain, phase] of numbers, in Hz, dB and degrees",
};

const SLOPES: &[&str] = &[EndSlope::ALL[0].word(), EndSlope::ALL[1].word()];

pub(crate) const DRIVE: Section = Section {
    name: "drive",
    meaning: "the boundary condition at the driven end",
    kind_field: "end",
    kinds: kinds! { spec, has:
        "displacement" [slope]
            { spec.drive_end, DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. } }
            = if has("slope") {
                DriveEnd::DisplacementAndSlope { slope: EndSlope::Free }
            } else {
                DriveEnd::Displacement
            };
        "force" [at_frequency_hz] { spec.drive_end, DriveEnd::Force { .. } }
            = DriveEnd::Force { at_frequency_hz: 0.0 };
        "resistance" [ratio at_frequency_hz] { spec.drive_end, DriveEnd::Resistance { .. } }
            = DriveEnd::Resistance { ratio: 0.0, at_frequency_hz: 0.0 };
        "source" [at_frequency_hz resistance_n_s_per_m mass_kg stiffness_n_per_m slope]
            { spec.drive_end, DriveEnd::Source(_) }
            = {
                let soft = Source::soft(&spec.model, 0.0);
                let stated = has("slope").then_some(EndSlope::Free);
                DriveEnd::Source(Source { slope: soft.slope.or(stated), ..soft })
            };
    },
    not_a_kind: NONE,
    fields: fields! { spec:
        end: FieldType::Kind, "the boundary condition at the driven end";
        slope: FieldType::OneOf(SLOPES), "what holds the slope of an end in bending"
            { spec.drive_end, DriveEnd::DisplacementAndSlope { slope: it }
                | DriveEnd::Source(Source { slope: Some(it), .. }) => Slot::Slope(it) };
        resistance_n_s_per_m: FieldType::Number(limits::MECHANICAL_RESISTANCE), "resistance of the driven end"
            ["End resistance", Unit::Times("N s/m", 1.0)] (or 0.0)
            { spec.drive_end, DriveEnd::Source(it) => Slot::Number(&mut it.impedance.resistance_n_s_per_m) };
        mass_kg: FieldType::Number(limits::MOVING_MASS), "mass that moves with the driven end"
            ["Moving mass", Unit::Times("g", 1e-3)] (or 0.0)
            { spec.drive_end, DriveEnd::Source(it) => Slot::Number(&mut it.impedance.mass_kg) };
        stiffness_n_per_m: FieldType::Number(limits::END_STIFFNESS), "stiffness of the driven end against the frame"
            ["End stiffness", Unit::Times("N/m", 1.0)] (or 0.0)
            { spec.drive_end, DriveEnd::Source(it) => Slot::Number(&mut it.impedance.stiffness_n_per_m) };
        lead_in: FieldType::Section, "a strip with loss behind the drive";
        ratio: FieldType::Number(limits::DRIVE_RATIO), "the resistance over the wave's own"
            ["Resistance ratio", Unit::Pure]
            { spec.drive_end, DriveEnd::Resistance { ratio: it, .. } => Slot::Number(it) };
        at_frequency_hz: FieldType::NumberThat("in Hz, so high that it enters the plate"), "the frequency that it is stated for"
            ["Frequency of the resistance", Unit::Hertz]
            { spec.drive_end, DriveEnd::Force { at_frequency_hz: it }
                | DriveEnd::Resistance { at_frequency_hz: it, .. }
                | DriveEnd::Source(Source { at_frequency_hz: it, .. }) => Slot::Number(it) };
    },
};

pub(super) const LEAD_IN: Section = Section {
    name: "drive.lead_in",
    meaning: "a strip with loss behind the drive of a plate in bending",
    kind_field: "",
    kinds: &[Kind {
        word: "",
        fields: &[],
        is: |spec| matches!(spec.drive_end, DriveEnd::Source(Source { lead_in: Some(_), .. })),
        begin: |spec, _| {
            if let DriveEnd::Source(source) = &mut spec.drive_end {
                source.lead_in =
                    Some(LeadIn { length_m: 0.0, loss_factor: 0.0, end_resistance_n_s_per_m: 0.0 });
            }
        },
    }],
    not_a_kind: NONE,
    fields: fields! { spec:
        length_m: FieldType::Number(limits::LEAD_IN_LENGTH), "length of the lead-in" ["Lead-in length", MM]
            { spec.drive_end, DriveEnd::Source(Source { lead_in: Some(it), .. }) => Slot::Number(&mut it.length_m) };
        loss_factor: FieldType::Number(limits::LEAD_IN_LOSS), "loss factor of the lead-in with its layer"
            ["Lead-in loss factor", Unit::Pure]
            { spec.drive_end, DriveEnd::Source(Source { lead_in: Some(it), .. }) => Slot::Number(&mut it.loss_factor) };
        end_resistance_n_s_per_m: FieldType::Number(limits::MECHANICAL_RESISTANCE),
            "resistance at the far end of the lead-in" ["Lead-in damper", Unit::Times("N s/m", 1.0)] (or 0.0)
            { spec.drive_end, DriveEnd::Source(Source { lead_in: Some(it), .. })
                => Slot::Number(&mut it.end_resistance_n_s_per_m) };
    },
};

/// The air of a mounting: given by its two numbers, or that of a room.
fn around(has: &dyn Fn(&str) -> bool, mounting: AirMounting) -> Option<Air> {
    let given = Gas::Given { density_kg_per_m3: 0.0, sound_speed_m_per_s: 0.0 };
    let is_given = has("density_kg_per_m3") || has("sound_speed_m_per_s");
    Some(Air::Around { gas: if is_given { given } else { Gas::ROOM }, mounting, gap_m: None })
}

const BOTH: Faces = Faces::Two;

pub(super) const AIR: Section = Section {
    name: "air",
    meaning: "the air that swings with the plate",
    kind_field: "mounting",
    kinds: kinds! { spec, has:
        "baffle" [faces density_kg_per_m3 sound_speed_m_per_s temperature_c height_m]
            { spec.air, Some(Air::Around { mounting: AirMounting::Baffle { .. }, .. }) }
            = around(has, AirMounting::Baffle { faces: BOTH });
        "bare-frame" [gap_m density_kg_per_m3 sound_speed_m_per_s temperature_c height_m]
            { spec.air, Some(Air::Around { mounting: AirMounting::BareFrame, .. }) }
            = around(has, AirMounting::BareFrame);
        "unknown" [gap_m density_kg_per_m3 sound_speed_m_per_s temperature_c height_m]
            { spec.air, Some(Air::Around { mounting: AirMounting::Unknown, .. }) }
            = around(has, AirMounting::Unknown);
        "coefficient" [coefficient faces gap_m density_kg_per_m3 sound_speed_m_per_s temperature_c height_m]
            { spec.air, Some(Air::Around { mounting: AirMounting::Coefficient { .. }, .. }) }
            = around(has, AirMounting::Coefficient { alpha: 0.0, faces: BOTH });
        "calibrated" [coefficient distant_share faces gap_m density_kg_per_m3 sound_speed_m_per_s temperature_c height_m]
            { spec.air, Some(Air::Around { mounting: AirMounting::Calibrated { .. }, .. }) }
            = around(has, AirMounting::Calibrated { alpha: 0.0, faces: BOTH, distant: 0.0 });
        "vacuum" [] { spec.air, Some(Air::Vacuum) } = Some(Air::Vacuum);
    },
    not_a_kind: (
        "closed-box",
        "a closed box is a spring against the volume that the plate moves, which no law here has: open its back",
    ),
    fields: fields! { spec:
        mounting: FieldType::Kind, "how the plate stands in the air";
        coefficient: FieldType::Number(limits::AIR_COEFFICIENT),
            "the air's mass on each face over that of an endless plane wave" ["Air coefficient", Unit::Pure]
            { spec.air, Some(Air::Around {
                mounting: AirMounting::Coefficient { alpha: it, .. } | AirMounting::Calibrated { alpha: it, .. }, ..
            }) => Slot::Number(it) };
        distant_share: FieldType::Number(limits::DISTANT_AIR), "the pressure at a distance over that in a baffle"
            ["Distant share", Unit::Pure]
            { spec.air, Some(Air::Around { mounting: AirMounting::Calibrated { distant: it, .. }, .. })
                => Slot::Number(it) };
        faces: FieldType::NumberThat("1 or 2"), "how many faces have air"
            { spec.air, Some(Air::Around {
                mounting: AirMounting::Baffle { faces: it }
                    | AirMounting::Coefficient { faces: it, .. }
                    | AirMounting::Calibrated { faces: it, .. }, ..
            }) => Slot::Faces(it) };
        gap_m: FieldType::Number(limits::AIR_GAP), "distance of a table from the lower face" ["Table below", MM]
            { spec.air, Some(Air::Around { gap_m: it, .. }) => Slot::Optional(it) };
        density_kg_per_m3: FieldType::Number(limits::AIR_DENSITY), "density of the air"
            ["Air density", Unit::Times("kg/m³", 1.0)]
            { spec.air, Some(Air::Around { gas: Gas::Given { density_kg_per_m3: it, .. }, .. }) => Slot::Number(it) };
        sound_speed_m_per_s: FieldType::Number(limits::SOUND_SPEED), "speed of sound"
            ["Speed of sound", Unit::Times("m/s", 1.0)]
            { spec.air, Some(Air::Around { gas: Gas::Given { sound_speed_m_per_s: it, .. }, .. }) => Slot::Number(it) };
        temperature_c: FieldType::Number(limits::AIR_TEMPERATURE), "temperature of the air"
            ["Temperature", Unit::Times("°C", 1.0)] (or 20.0)
            { spec.air, Some(Air::Around { gas: Gas::Atmosphere { temperature_c: it, .. }, .. }) => Slot::Number(it) };
        height_m: FieldType::Number(limits::AIR_HEIGHT), "height above the sea"
            ["Height above sea", Unit::Times("m", 1.0)] (or 0.0)
            { spec.air, Some(Air::Around { gas: Gas::Atmosphere { height_m: it, .. }, .. }) => Slot::Number(it) };
    },
};

const HARMONIC: Columns = Columns {
    points: limits::CURVE_POINTS,
    one: "a triple [frequency, level, phase] of numbers, in Hz, dB and degrees",
    many: "triples [frequency, level, phase] of numbers, in Hz, dB and degrees",
};

/// The fields of the harmonics' points.
pub(crate) const HARMONIC_POINTS: [&str; 2] = ["harmonic_2_points", "harmonic_3_points"];

/// The harmonics, where the file has their points.
fn harmonics(has: &dyn Fn(&str) -> bool) -> Option<Harmonics> {
    let [second, third] = HARMONIC_POINTS.map(|name| has(name).then(|| ResponseCurve { points: Vec::new() }));
    (second.is_some() || third.is_some()).then_some(Harmonics { level: 0.0, second, third })
}

const NO_FRAME: Frame = Frame {
    youngs_modulus_pa: 0.0,
    density_kg_per_m3: 0.0,
    thickness_m: 0.0,
    rim_m: 0.0,
    table_mass_kg: 0.0,
};

pub(super) const FRAME: Section = Section {
    name: "frame",
    meaning: "the frame that holds the plate",
    kind_field: "",
    kinds: kinds! { spec, has: "" [] { spec.frame, Some(_) } = Some(NO_FRAME); },
    not_a_kind: NONE,
    fields: fields! { spec:
        youngs_modulus_pa: FieldType::Number(limits::YOUNGS_MODULUS), "Young's modulus of the frame"
            ["Frame modulus", Unit::Times("GPa", 1e9)]
            { spec.frame, Some(it) => Slot::Number(&mut it.youngs_modulus_pa) };
        density_kg_per_m3: FieldType::Number(limits::DENSITY), "density of the frame"
            ["Frame density", Unit::Times("kg/m³", 1.0)]
            { spec.frame, Some(it) => Slot::Number(&mut it.density_kg_per_m3) };
        thickness_m: FieldType::Number(limits::FRAME_THICKNESS), "thickness of both sheets of the frame together"
            ["Frame thickness", MM]
            { spec.frame, Some(it) => Slot::Number(&mut it.thickness_m) };
        rim_m: FieldType::Number(limits::RIM), "width of the rim around the window" ["Rim", MM]
            (or 0.02)
            { spec.frame, Some(it) => Slot::Number(&mut it.rim_m) };
        table_mass_kg: FieldType::Number(limits::MOVING_MASS), "mass of the table to which the frame is screwed"
            ["Table mass", Unit::Times("kg", 1.0)] (or 0.0)
            { spec.frame, Some(it) => Slot::Number(&mut it.table_mass_kg) };
    },
};

/// A measured curve where the file has its points, else a resonator; half a travel is none, so its two fields belong together.
fn actuator(has: &dyn Fn(&str) -> bool) -> Actuator {
    if has("points") {
        return Actuator::Measured(ResponseCurve { points: Vec::new() });
    }
    let is_limited = has("peak_travel_m") || has("static_travel_m");
    let travel = is_limited.then_some(Travel { peak_m: 0.0, static_m: 0.0 });
    Actuator::Resonator(Resonator { resonance_hz: 0.0, quality: 0.0, travel })
}

pub(super) const ACTUATOR: Section = Section {
    name: "actuator",
    meaning: "what lies between the DAC and the driven end",
    kind_field: "",
    kinds: &[Kind {
        word: "",
        fields: &[],
        is: |spec| {
            spec.actuator.is_some() || spec.harmonics.is_some() || spec.amplifier_bandwidth_hz.is_some()
        },
        begin: |spec, has| {
            spec.harmonics = harmonics(has);
            spec.amplifier_bandwidth_hz = has("amplifier_bandwidth_hz").then_some(0.0);
            // A file may state these alone: then nothing lies between the DAC and the driven end.
            let has_others = spec.harmonics.is_some() || spec.amplifier_bandwidth_hz.is_some();
            let responds = ["resonance_hz", "quality", "peak_travel_m", "static_travel_m", "points"];
            let is_stated = !has_others || responds.into_iter().any(has);
            spec.actuator = is_stated.then(|| actuator(has));
        },
    }],
    not_a_kind: NONE,
    fields: fields! { spec:
        resonance_hz: FieldType::Number(limits::RESONANCE), "resonance of the actuator" ["Resonance", Unit::Hertz]
            { spec.actuator, Some(Actuator::Resonator(it)) => Slot::Number(&mut it.resonance_hz) };
        quality: FieldType::Number(limits::QUALITY), "quality factor of the resonance" ["Quality", Unit::Pure]
            { spec.actuator, Some(Actuator::Resonator(it)) => Slot::Number(&mut it.quality) };
        peak_travel_m: FieldType::Number(limits::TRAVEL), "farthest that the actuator may move from its rest"
            ["Peak travel", MM]
            { spec.actuator, Some(Actuator::Resonator(Resonator { travel: Some(it), .. })) => Slot::Number(&mut it.peak_m) };
        static_travel_m: FieldType::Number(limits::TRAVEL), "how far a steady signal at DAC full scale would move it"
            ["Travel at full scale", MM]
            { spec.actuator, Some(Actuator::Resonator(Resonator { travel: Some(it), .. })) => Slot::Number(&mut it.static_m) };
        points: FieldType::Points(&CURVE), "the measured response"
            { spec.actuator, Some(Actuator::Measured(it)) => Slot::Triples(&mut it.points) };
        amplifier_bandwidth_hz: FieldType::Number(limits::BANDWIDTH), "bandwidth of the amplifier"
            { spec.amplifier_bandwidth_hz, Some(it) => Slot::Number(it) };
        harmonic_level: FieldType::Number(limits::HARMONIC_LEVEL), "level of the tone at which the harmonics hold"
            { spec.harmonics, Some(it) => Slot::Number(&mut it.level) };
        harmonic_2_points: FieldType::Points(&HARMONIC), "the drive's second harmonic over its fundamental"
            { spec.harmonics, Some(Harmonics { second: Some(it), .. }) => Slot::Triples(&mut it.points) };
        harmonic_3_points: FieldType::Points(&HARMONIC), "the drive's third harmonic over its fundamental"
            { spec.harmonics, Some(Harmonics { third: Some(it), .. }) => Slot::Triples(&mut it.points) };
    },
};

/// The three tolerances of the source belong together.
fn calibration(has: &dyn Fn(&str) -> bool) -> Calibration {
    Calibration {
        chi2_per_n: 0.0,
        half_width_tolerance: 0.0,
        taper_tolerance: 0.0,
        level_tolerance_db: None,
        source_tolerance: SOURCE_TOLERANCE.into_iter().any(has).then(Impedance::default),
        correction: has("points").then(|| ResponseCurve { points: Vec::new() }),
    }
}

pub(super) const CALIBRATION: Section = Section {
    name: "calibration",
    meaning: "how well the plate was measured, and what its drive does over what the file says",
    kind_field: "",
    kinds: kinds! { spec, has: "" [] { spec.calibration, Some(_) } = Some(calibration(has)); },
    not_a_kind: NONE,
    fields: fields! { spec:
        chi2_per_n: FieldType::Number(limits::CHI2_PER_N), "how well the measurement fits"
            { spec.calibration, Some(it) => Slot::Number(&mut it.chi2_per_n) };
        half_width_tolerance: FieldType::Number(limits::CALIBRATED), "how well the half-width at the driven end is known"
            { spec.calibration, Some(it) => Slot::Number(&mut it.half_width_tolerance) };
        taper_tolerance: FieldType::Number(limits::CALIBRATED), "how well ln(W0/W(L)) is known"
            { spec.calibration, Some(it) => Slot::Number(&mut it.taper_tolerance) };
        level_tolerance_db: FieldType::Number(limits::LEVEL_TOLERANCE_DB), "how well the level of the peak is known"
            { spec.calibration, Some(it) => Slot::Optional(&mut it.level_tolerance_db) };
        resistance_tolerance_n_s_per_m: FieldType::Number(limits::MECHANICAL_RESISTANCE),
            "how well the drive's resistance is known"
            { spec.calibration, Some(Calibration { source_tolerance: Some(it), .. })
                => Slot::Number(&mut it.resistance_n_s_per_m) };
        mass_tolerance_kg: FieldType::Number(limits::MOVING_MASS), "how well the drive's moving mass is known"
            { spec.calibration, Some(Calibration { source_tolerance: Some(it), .. }) => Slot::Number(&mut it.mass_kg) };
        stiffness_tolerance_n_per_m: FieldType::Number(limits::END_STIFFNESS), "how well the drive's stiffness is known"
            { spec.calibration, Some(Calibration { source_tolerance: Some(it), .. })
                => Slot::Number(&mut it.stiffness_n_per_m) };
        points: FieldType::Points(&CURVE), "the measured gain over what the file gives"
            { spec.calibration, Some(Calibration { correction: Some(it), .. }) => Slot::Triples(&mut it.points) };
    },
};
