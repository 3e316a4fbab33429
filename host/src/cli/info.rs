//! `slipline ports` and `slipline info`.

use super::defaults::{Chosen, defaults};
use super::device::Device;
use super::failure::Failure;
use super::output;
use super::rig::PortArgument;
use serde_json::json;
use slipline_instrument::device_info::{DeviceInfo, PortAnswer};
use slipline_link::native::list_ports;
use slipline_link::upkeep;
use slipline_plate::quantity::number_format::with_decimals;

pub(super) fn ports(as_json: bool) -> Result<(), Failure> {
    let ports = list_ports();
    let list: Vec<_> = ports.iter().map(PortAnswer::from).collect();
    output::print(as_json, &json!({ "ports": list }), |out| {
        let names: Vec<String> = ports.iter().map(|info| info.port.to_string()).collect();
        let lines: Vec<_> =
            names.iter().zip(&ports).map(|(name, info)| (name.as_str(), info.label.clone())).collect();
        output::lines(out, &lines)
    })
}

pub(super) fn run(argument: &PortArgument, as_json: bool) -> Result<(), Failure> {
    let port = &argument.port()?;
    let device = Device::observe(port, argument.rig(None)?.as_ref())?;
    let snapshot = device.snapshot();
    let round_trip_s = snapshot.link.round_trip.average.as_secs_f64();
    let defaults = defaults();
    let option = Chosen { value: port.to_string(), from: "option" };
    let of_port = if argument.is_given() { option } else { defaults.port.clone()? };
    let settings_file = defaults.file.as_ref().map(|file| file.display().to_string());
    let mut value = json!(DeviceInfo::of(port, &snapshot));
    value["defaults"] = json!({
        "port": of_port.value(),
        "plate": defaults.plate.as_ref().ok().map(Chosen::value),
        // JSON, text: The settings file, whether or not it exists
        "settings_file": settings_file,
    });
    let plate = defaults.plate.as_ref().map_or_else(ToString::to_string, Chosen::words);
    output::print(as_json, &value, |out| {
        let mut lines = vec![("Port", of_port.words()), ("Default plate", plate)];
        lines.extend(settings_file.map(|file| ("Settings file", file)));
        if let Some(it) = snapshot.device.identity.as_deref() {
            lines.push(("Board", it.board.to_string()));
            let (major, minor, patch) = it.firmware;
            lines.push(("Firmware", format!("{major}.{minor}.{patch} ({})", it.build)));
            lines.push(("Protocol", format!("{}.{}", it.version.major, it.version.minor)));
            lines.push(("Unit", snapshot.unit().unwrap_or_default()));
            let rate = f64::from(it.sample_rate_hz) / 1e3;
            lines.push(("Samples", format!("{rate} kS/s, {} bits, blocks of {}", it.dac_bits, it.block)));
            lines.push(("Tones", format!("{}", it.tones)));
            lines.push(("Last reset", words(&it.reset)));
            lines.push(("Kept in flash", words(&it.stored)));
        }
        if let Some(it) = &snapshot.device.maintenance {
            lines.push(("Flash erased", upkeep::wear(it)));
            lines.push(("Brown-out level", upkeep::brown_out_level(it).to_owned()));
            lines.extend(upkeep::before_arming(it).map(|warning| ("Warning", warning.to_owned())));
            lines.extend(upkeep::worn(it).map(|warning| ("Warning", warning)));
        }
        if let Some(it) = &snapshot.device.wear {
            lines.push(("Profile's flash erased", upkeep::profile_wear(it)));
        }
        if let Some(it) = &snapshot.device.analogue {
            lines.extend(upkeep::reference(it).map(|text| ("Reference voltage", text)));
            lines.push(("Linear output", upkeep::linear_output(it)));
            lines.extend(upkeep::wrong_reference(it).map(|warning| ("Warning", warning)));
        }
        if let Some(it) = &snapshot.device.board {
            lines.extend(upkeep::user_button(it).map(|state| ("User button", state.to_owned())));
            lines.extend(upkeep::stop_input(it).map(|state| ("Stop input", state.to_owned())));
            lines.extend(upkeep::muted_for_good(it).map(|warning| ("Warning", warning.to_owned())));
        }
        if let Some(it) = &snapshot.device.profile {
            let name = it.profile.as_ref().map_or("none", |profile| profile.name.as_str());
            lines.push(("Actuator profile", name.to_owned()));
        }
        lines.extend(snapshot.device.inputs.iter().map(|it| ("Inputs", upkeep::inputs(it))));
        lines.push(("Versions", snapshot.device.compatibility.map_or("", |it| it.sentence()).to_owned()));
        if let Some(it) = snapshot.drive.status {
            lines.push(("State", words(&it.state)));
            lines.push(("Faults", snapshot.faults_text(it.faults)));
            if it.counters.max_cycles > 0 {
                let share =
                    snapshot.worst_block().map(|share| format!(", {:.0} % of its time", share * 100.0));
                let share = share.unwrap_or_default();
                lines.push(("Worst block", format!("{} cycles{share}", it.counters.max_cycles)));
                let warning = snapshot.worst_block().and_then(upkeep::hardly_in_time);
                lines.extend(warning.map(|warning| ("Warning", warning)));
            }
        }
        let table = snapshot.table.report.active.map_or_else(
            || "none".to_owned(),
            |it| {
                let (start, end) = slipline_link::span_m(&it);
                format!("{:08x}, {} knots, {:.1} to {:.1} mm", it.crc, it.knots, start * 1e3, end * 1e3)
            },
        );
        lines.push(("Table", table));
        lines.push(("Round trip", format!("{} ms", with_decimals(round_trip_s * 1e3, 2))));
        output::lines(out, &lines)
    })
}

/// A name of the protocol as words: `PowerOn` is `power on`.
fn words(name: &impl std::fmt::Debug) -> String {
    let name = format!("{name:?}");
    let letters = name.char_indices().flat_map(|(at, letter)| {
        let space = (at > 0 && letter.is_ascii_uppercase()).then_some(' ');
        space.into_iter().chain([letter.to_ascii_lowercase()])
    });
    letters.collect()
}
