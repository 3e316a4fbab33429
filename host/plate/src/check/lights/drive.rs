//! The light for the driven end: how much of the returning wave it sends back.

use crate::check::grading::{Finding, Site, colour};
use crate::check::report::{Colour, Limit};
use crate::check::thresholds::DRIVE_REFLECTION;
use crate::frequency::driven_end::{reflection, resistance_reflection};
use crate::spec::drive::DriveEnd;
use crate::spec::impedance::Impedance;
use crate::spec::plate::Plate;
use crate::spec::source::Source;

/// The light's value is |r| of the end as it really is; for an end in bending whose near field the file leaves out, it is
/// that of the free end with the same damper.
pub(in crate::check) fn match_light(site: &Site<'_>) -> Finding {
    let reflected = |plate: &Plate| reflection(plate, site.frequency_hz).map_or(1.0, |r| r.norm());
    let in_equation = reflected(site.plate);
    let end = site.plate.spec().drive_end;
    let is_one_mode_bending =
        site.plate.spec().model.bending().is_some() && matches!(end, DriveEnd::Resistance { .. });
    let value = if is_one_mode_bending {
        resistance_reflection(site.plate, site.frequency_hz).map(|r| r.norm())
    } else {
        Some(in_equation)
    };
    let mut judged = colour(in_equation, DRIVE_REFLECTION);
    if is_one_mode_bending {
        judged = judged.max(Colour::Amber);
    }
    let percent = 100.0 * value.unwrap_or(in_equation);
    let sentence = match (judged, end) {
        (_, DriveEnd::Resistance { .. }) if is_one_mode_bending => {
            let really = value.map_or_else(
                || "a share that is not known".to_owned(),
                |_| format!("{percent:.0} %"),
            );
            format!(
                "A damper alone does not match a plate in bending: at a real end it sends {really} of the returning wave back (this file leaves the near field out). Use a source with a damped lead-in."
            )
        }
        (Colour::Green | Colour::Unchecked, _) => format!(
            "The drive end absorbs the returning wave ({percent:.0} % comes back): the plate hardly resonates."
        ),
        (_, DriveEnd::Source(source)) if hides_its_match(site, source) => format!(
            "The mass and the stiffness of the drive end hide what would absorb the wave: {percent:.0} % of it comes back. Use a softer actuator."
        ),
        (Colour::Amber, _) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: the plate resonates a little; a closer match of its resistance helps."
        ),
        (Colour::Red, DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. }) => {
            "The drive end holds its displacement and sends every wave back: the plate is a resonator, and a damper or a lead-in behind it would be hidden. Drive it by a force.".to_owned()
        }
        (Colour::Red, DriveEnd::Force { .. }) => {
            "The drive end holds its force and sends every wave back: the plate is a resonator, put a damper at its end.".to_owned()
        }
        (Colour::Red, DriveEnd::Resistance { .. }) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: choose its resistance for this frequency."
        ),
        (Colour::Red, DriveEnd::Source(_)) if site.plate.spec().model.bending().is_some() => format!(
            "The drive end sends {percent:.0} % of the returning wave back: give it a longer or more lossy lead-in."
        ),
        (Colour::Red, DriveEnd::Source(_)) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: give it the wave's resistance, and less mass and stiffness."
        ),
    };
    let found = site.judged("drive match", value, "", judged, in_equation, sentence).at(0.0);
    // What a damper in bending sends back in the equation is not what its light tells.
    if is_one_mode_bending { found } else { found.limited(Limit::AtMost(DRIVE_REFLECTION)) }
}

/// Whether the end would match without its own mass and stiffness.
fn hides_its_match(site: &Site<'_>, source: Source) -> bool {
    let mut spec = site.plate.spec().clone();
    let impedance = Impedance::damper(source.impedance.resistance_n_s_per_m);
    spec.drive_end = DriveEnd::Source(Source { impedance, ..source });
    let soft = Plate::new(spec).ok().and_then(|plate| reflection(&plate, site.frequency_hz));
    soft.is_some_and(|r| r.norm() <= DRIVE_REFLECTION.green)
}
