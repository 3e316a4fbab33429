//! The air around the plate on the screen: how the plate stands in it, and what air it is.

use crate::view::fields::choice::choice;
use crate::view::panels::plate_panel::numbers::{Numbers, changed};
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_plate::{Air, AirMounting, Faces, Gas, Model};

const MOUNTING_HELP: &str =
    "How the plate stands in the air that swings with it: a light plate turns earlier in air";
const FACES_HELP: &str = "How many faces of the plate have air";
const GAS_HELP: &str = "The two numbers that determine density and speed of sound";

/// Width of a list, in points.
const LIST: f32 = 150.0;

/// Shows the section, for a plate whose wave carries air.
pub(super) fn show(ui: &mut egui::Ui, numbers: &mut Numbers<'_, '_>) {
    let spec = numbers.plate.spec();
    if let Model::ShearHorizontal { .. } = spec.model {
        return;
    }
    let air = spec.air;
    ui.separator();
    theme::heading(ui, "Air");
    let (shown, _) = stated(air);
    let entries: Vec<_> = mountings(air).into_iter().map(|air| (stated(air), air)).collect();
    offer(ui, numbers, ("Mounting", shown, MOUNTING_HELP), &entries, air);
    let Some(Air::Around { gas, mounting, gap_m }) = air else {
        let bare = changed(numbers.plate, |spec| spec.air = Some(Air::ROOM));
        if let Err(reason) = bare {
            ui.label(RichText::new(reason).small().color(theme::palette(ui).weak));
        }
        return;
    };
    let around = |gas, mounting| Some(Air::Around { gas, mounting, gap_m });
    numbers.show(ui, &["air.coefficient", "air.distant_share", "air.gap_m"]);
    let (_, faces) = mounting.coefficient();
    let with = |faces| match mounting {
        AirMounting::Baffle { .. } => Some(AirMounting::Baffle { faces }),
        AirMounting::Coefficient { alpha, .. } => Some(AirMounting::Coefficient { alpha, faces }),
        AirMounting::Calibrated { alpha, distant, .. } => {
            Some(AirMounting::Calibrated { alpha, faces, distant })
        }
        AirMounting::BareFrame | AirMounting::Unknown => None,
    };
    if let Some((one, two)) = with(Faces::One).zip(with(Faces::Two)) {
        let shown = if faces == Faces::One { "one" } else { "both" };
        let entries = [
            (("both", "Air in front of the plate and behind it"), around(gas, two)),
            (
                ("one", "Air on one face; a vacuum or a light foam that holds no air on the other"),
                around(gas, one),
            ),
        ];
        offer(ui, numbers, ("Faces with air", shown, FACES_HELP), &entries, air);
    }
    gas_numbers(ui, numbers, (gas, mounting, gap_m));
}

/// Temperature and height, or density and speed of sound.
fn gas_numbers(
    ui: &mut egui::Ui,
    numbers: &mut Numbers<'_, '_>,
    (gas, mounting, gap_m): (Gas, AirMounting, Option<f64>),
) {
    let (density_kg_per_m3, sound_speed_m_per_s) = (gas.density_kg_per_m3(), gas.sound_speed_m_per_s());
    let (given, atmosphere) = match gas {
        Gas::Given { .. } => (gas, Gas::ROOM),
        Gas::Atmosphere { .. } => (Gas::Given { density_kg_per_m3, sound_speed_m_per_s }, gas),
    };
    let around = |gas| Some(Air::Around { gas, mounting, gap_m });
    let entries = [
        (("temperature", "Dry air of this temperature, at this height above the sea"), around(atmosphere)),
        (("density", "The density of the air and the speed of sound in it"), around(given)),
    ];
    let shown = if gas == given { "density" } else { "temperature" };
    offer(ui, numbers, ("Air by", shown, GAS_HELP), &entries, around(gas));
    numbers
        .show(ui, &["air.density_kg_per_m3", "air.sound_speed_m_per_s", "air.temperature_c", "air.height_m"]);
}

/// The ways to stand in the air, with what else is stated kept. Only a calibration makes one that is calibrated.
fn mountings(air: Option<Air>) -> Vec<Option<Air>> {
    let (gas, (alpha, faces), gap_m) = match air {
        Some(Air::Around { gas, mounting, gap_m }) => (gas, mounting.coefficient(), gap_m),
        None | Some(Air::Vacuum) => (Gas::ROOM, AirMounting::BareFrame.coefficient(), None),
    };
    // A baffle has no gap.
    let around = |mounting: AirMounting| {
        let gap_m = gap_m.filter(|_| !matches!(mounting, AirMounting::Baffle { .. }));
        Some(Air::Around { gas, mounting, gap_m })
    };
    let mut all = vec![
        None,
        Some(Air::Vacuum),
        around(AirMounting::Baffle { faces }),
        around(AirMounting::BareFrame),
        around(AirMounting::Unknown),
        around(AirMounting::Coefficient { alpha, faces }),
    ];
    if let Some(AirMounting::Calibrated { .. }) = air.and_then(|air| air.mounting()) {
        all.push(air);
    }
    all
}

/// Name and meaning of a way to stand in the air.
fn stated(air: Option<Air>) -> (&'static str, &'static str) {
    let Some(air) = air else {
        return ("not stated", "Nothing is added: a wave speed that was measured in air includes it already");
    };
    match air.mounting() {
        None => ("vacuum", "No air: the plate as it is by itself"),
        Some(AirMounting::Baffle { .. }) => {
            ("baffle", "In a wide wall, so that no air goes from one face to the other")
        }
        Some(AirMounting::BareFrame) => ("bare frame", "In a narrow frame, with air on both faces"),
        Some(AirMounting::Unknown) => (
            "not known",
            "Between a bare frame and a baffle: a calibration finds how much air swings with it",
        ),
        Some(AirMounting::Calibrated { .. }) => {
            ("calibrated", "The air's mass and its pressure at a distance as a calibration found them")
        }
        Some(AirMounting::Coefficient { .. }) => {
            ("coefficient", "The air's mass on each face over that of an endless plane wave, as a number")
        }
    }
}

/// Offers these kinds of air; what the plate cannot have is disabled, with the reason.
fn offer(
    ui: &mut egui::Ui,
    numbers: &mut Numbers<'_, '_>,
    list: (&str, &str, &str),
    entries: &[((&'static str, &'static str), Option<Air>)],
    now: Option<Air>,
) {
    let chosen = choice(ui, list, LIST, |ui| {
        let mut chosen = None;
        for ((name, meaning), air) in entries {
            let other = changed(numbers.plate, |spec| spec.air = *air);
            let entry = ui.add_enabled(other.is_ok(), egui::Button::selectable(*air == now, *name));
            match other {
                Ok(plate) => {
                    if entry.on_hover_text(*meaning).clicked() && *air != now {
                        chosen = Some(plate);
                    }
                }
                Err(reason) => drop(entry.on_disabled_hover_text(reason)),
            }
        }
        chosen
    });
    if let Some(plate) = chosen {
        numbers.take(plate);
    }
}
