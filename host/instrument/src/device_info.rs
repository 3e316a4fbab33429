//! What a device reports of itself, under the names and in the units that every shell gives it.

use serde::Serialize;
use slipline_link::protocol::command::TableHeader;
use slipline_link::protocol::event::{Counters, Identity, Status};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{Port, PortInfo, Snapshot};
use std::fmt::Debug;

/// The identity and state of a device; `None` where it does not report a value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeviceInfo {
    /// The port, as it is written.
    // JSON, text: The port, as --port takes it
    pub port: String,
    /// Whether firmware and program are compatible, as a sentence.
    // JSON, text: How the versions of device and program agree
    pub compatibility: &'static str,
    /// The board.
    // JSON, text: The board
    pub board: Option<String>,
    /// The firmware's version: `1.2.3`.
    // JSON, text: Version of the firmware
    pub firmware: Option<String>,
    /// The firmware's build.
    // JSON, text: The firmware's build
    pub build: Option<String>,
    /// The protocol's version: `1.3`.
    // JSON, text: Version of the device's protocol
    pub protocol: Option<String>,
    /// The chip's unique id in hexadecimal.
    // JSON of info, text: Number of this device
    pub unit: Option<String>,
    /// Whether the device is simulated.
    // JSON, true or false: Whether the device is simulated
    pub simulated: Option<bool>,
    /// Samples of the DAC per second.
    pub sample_rate_hz: Option<u32>,
    /// Samples in a block.
    // JSON: Samples of a block
    pub block_samples: Option<u16>,
    /// Bits of the DAC.
    // JSON, count: Bits of the DAC
    pub dac_bits: Option<u8>,
    /// Tones at once.
    // JSON, count: Most tones at once
    pub max_tones: Option<u8>,
    /// Knots of a table.
    // JSON, count: Most knots of a table
    pub max_knots: Option<u16>,
    /// Time without a sign of the computer after which the device stops.
    // JSON: Silence of the host after which the device stops
    pub dead_man_s: Option<f64>,
    /// Why it was reset last.
    // JSON, text: Cause of the device's last reset
    pub reset: Option<String>,
    /// What is stored in its flash.
    // JSON, text: Content of the device's flash
    pub stored: Option<String>,
    /// Erasures of the flash until now.
    // JSON, count: Erasures of the flash so far
    pub flash_erasures: Option<u32>,
    /// Erasures that its data sheet guarantees.
    // JSON, count: Erasures that its maker promises
    pub flash_erasures_promised: Option<u32>,
    /// Erasures of the flash of the actuator's profile until now.
    // JSON, count: Erasures of the flash of the actuator's profile so far
    pub profile_erasures: Option<u32>,
    /// Erasures of it that its data sheet guarantees.
    // JSON, count: Erasures of it that its maker promises
    pub profile_erasures_promised: Option<u32>,
    /// Tables that may be stored or forgotten now.
    // JSON, count: Tables that may be stored or forgotten in flash now
    pub stores_left: Option<u8>,
    /// Whether the brown-out level is set.
    // JSON, true or false: Whether the brown-out level is set; null for an older device
    pub brown_out_guarded: Option<bool>,
    /// The reference voltage VREF+; `None` where it is not measured.
    // JSON: Reference voltage of DAC and ADC; null where it is not measured
    pub reference_v: Option<f64>,
    /// The share of full scale within which the DAC's output is linear.
    // JSON, 1: Share of full scale within which the DAC's output is linear; null where it is not reported
    pub linear_share: Option<f64>,
    /// The processor's clock.
    // JSON: Clock of the device's processor; null where it is not reported
    pub core_hz: Option<u32>,
    /// The resistor at the mute pin.
    // JSON, text: State of the mute resistor
    pub mute_resistor: Option<String>,
    /// The user button.
    // JSON, text: State of the user button
    pub user_button: Option<String>,
    /// The stop input.
    // JSON, text: State of the stop input
    pub stop_input: Option<String>,
    /// The name of the actuator's profile; the inner `None` where the board keeps no profile.
    // JSON, text: Name of the actuator's profile; null if the device keeps none
    pub profile_name: Option<Option<String>>,
    /// Its inputs.
    pub inputs: Option<InputsInfo>,
    /// The text of its last crash.
    // JSON, text: Record of the last crash; null if there is none
    pub crash: Option<String>,
    /// Its state.
    // JSON, text: State of the device
    pub state: Option<String>,
    /// The faults in force, in words.
    // JSON, text: Latched faults
    pub faults: Vec<String>,
    /// The present sample index.
    // JSON: Index of the device's present sample
    pub now_samples: Option<u64>,
    /// Heat of the actuator over its limit.
    // JSON, 1: Estimated heat of the actuator, over its limit
    pub heat: Option<f64>,
    /// Its table.
    pub table: Option<TableInfo>,
    /// Its counters.
    pub counters: Option<CountersInfo>,
    /// Share of a block's time that the longest block took.
    // JSON, 1: Time of the longest block over its limit
    pub worst_block: Option<f64>,
    /// Average time from a command to its reply.
    // JSON: Mean round trip of a frame
    pub round_trip_s: f64,
    /// Whether a drive can wait for its trigger input.
    // JSON, true or false: Whether the device has a trigger input; null where it is not reported
    pub trigger_input: Option<bool>,
}

/// A port of this computer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PortAnswer {
    /// The port, as it is written.
    pub port: String,
    /// The port in words.
    // JSON, text: The port in words
    pub label: String,
    /// Whether it is known to be a Slipline device.
    // JSON, true or false: Whether it is known to be a Slipline device
    pub is_ours: bool,
    /// Serial number at USB; `None` without one.
    // JSON, text: Serial number at USB; null without one
    pub usb_serial: Option<String>,
}

impl From<&PortInfo> for PortAnswer {
    fn from(info: &PortInfo) -> Self {
        let PortInfo { port, label, is_ours, usb_serial } = info;
        Self {
            port: port.to_string(),
            label: label.clone(),
            is_ours: *is_ours,
            usb_serial: usb_serial.clone(),
        }
    }
}

/// The inputs of a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputsInfo {
    /// Number of inputs.
    // JSON, count: Number of inputs
    pub count: u8,
    /// Tones that are measured at once.
    // JSON, count: Lock-ins of the inputs
    pub lock_ins: u8,
    /// Delay of an input behind the DAC.
    // JSON: Delay of the inputs behind the DAC
    pub delay_s: f64,
    /// Blocks that were lost since the reset.
    // JSON, count: Blocks of the inputs that were lost
    pub lost_blocks: u32,
}

/// The table in force.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableInfo {
    /// Its CRC-32 in hexadecimal.
    pub crc: String,
    /// Number of knots.
    // JSON, count: Knots of the table
    pub knot_count: u16,
    /// The first place of the span.
    pub span_start_m: f64,
    /// The last place of the span.
    pub span_end_m: f64,
    /// The sample rate for which it was made.
    pub sample_rate_hz: u32,
}

/// The counters of a device since its reset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CountersInfo {
    /// Valid frames received.
    // JSON, count: Frames received
    pub frames: u32,
    /// Frames with a wrong CRC.
    // JSON, count: Frames with a wrong checksum
    pub crc_errors: u32,
    /// Frames that were too long.
    // JSON, count: Frames that were too long
    pub overlong: u32,
    /// Repeated commands.
    // JSON, count: Commands that came twice
    pub duplicates: u32,
    /// Frames that were dropped.
    // JSON, count: Frames that did not fit
    pub dropped: u32,
    /// Codes that were not ready in time.
    // JSON, count: Blocks that came too late
    pub underruns: u32,
    /// Samples beyond the DAC's range.
    pub clipped_samples: u32,
    /// Cycles of the longest block.
    // JSON, count: Cycles of the longest block
    pub max_cycles: u32,
}

impl DeviceInfo {
    /// What the device at this port has reported, by the latest snapshot.
    #[must_use]
    pub fn of(port: &Port, snapshot: &Snapshot) -> Self {
        let identity = snapshot.device.identity.as_deref();
        let status = snapshot.drive.status.as_ref();
        let maintenance = snapshot.device.maintenance.as_ref();
        let wear = snapshot.device.wear.as_ref();
        let board = snapshot.device.board.as_ref();
        let analogue = snapshot.device.analogue.as_ref();
        let text = |of: fn(&Identity) -> &str| identity.map(|it| of(it).to_owned());
        Self {
            port: port.to_string(),
            compatibility: snapshot.device.compatibility.map_or("", |compatibility| compatibility.sentence()),
            board: text(|it| it.board.as_str()),
            firmware: identity.map(|it| format!("{}.{}.{}", it.firmware.0, it.firmware.1, it.firmware.2)),
            build: text(|it| it.build.as_str()),
            protocol: identity.map(|it| format!("{}.{}", it.version.major, it.version.minor)),
            unit: snapshot.unit(),
            simulated: identity.map(|it| it.simulated),
            sample_rate_hz: identity.map(|it| it.sample_rate_hz),
            block_samples: identity.map(|it| it.block),
            dac_bits: identity.map(|it| it.dac_bits),
            max_tones: identity.map(|it| it.tones),
            max_knots: identity.map(|it| it.max_knots),
            dead_man_s: identity.map(|it| f64::from(it.dead_man_ms) / 1e3),
            reset: identity.map(|it| name(&it.reset)),
            stored: identity.map(|it| name(&it.stored)),
            flash_erasures: maintenance.map(|it| it.erasures),
            flash_erasures_promised: maintenance.map(|it| it.erasures_promised),
            profile_erasures: wear.map(|it| it.profile_erasures),
            profile_erasures_promised: wear.map(|it| it.profile_erasures_promised),
            stores_left: wear.map(|it| it.stores_left),
            brown_out_guarded: maintenance.map(|it| it.brown_out_guarded),
            reference_v: analogue.filter(|it| it.reference_mv > 0).map(|it| f64::from(it.reference_mv) / 1e3),
            linear_share: analogue.map(|it| f64::from(it.linear_per_mille) / 1e3),
            core_hz: board.map(|it| it.core_hz).filter(|&hz| hz > 0),
            mute_resistor: board.map(|it| name(&it.mute_resistor)),
            user_button: board.map(|it| name(&it.user_button)),
            stop_input: board.map(|it| name(&it.stop_input)),
            profile_name: snapshot
                .device
                .profile
                .as_ref()
                .map(|it| it.profile.as_ref().map(|profile| profile.name.as_str().to_owned())),
            inputs: snapshot.device.inputs.as_ref().map(InputsInfo::of),
            crash: text(|it| it.crash.as_str()).filter(|text| !text.is_empty()),
            state: status.map(|it| name(&it.state)),
            faults: status
                .iter()
                .flat_map(|it| it.faults.iter().map(|fault| snapshot.fault_text(fault).into_owned()))
                .collect(),
            now_samples: status.map(|it| it.now),
            heat: status.map(|it| f64::from(it.heat_per_mille) / 1e3),
            table: snapshot.table.report.active.as_ref().map(TableInfo::of),
            counters: status.map(CountersInfo::of),
            worst_block: snapshot.worst_block(),
            round_trip_s: snapshot.link.round_trip.average.as_secs_f64(),
            trigger_input: snapshot.has_trigger_input(),
        }
    }
}

impl InputsInfo {
    fn of(report: &InputsReport) -> Self {
        Self {
            count: report.inputs,
            lock_ins: report.lock_ins,
            delay_s: report.delay_ns as f64 * 1e-9,
            lost_blocks: report.lost_blocks,
        }
    }
}

impl TableInfo {
    fn of(header: &TableHeader) -> Self {
        Self {
            crc: format!("{:08x}", header.crc),
            knot_count: header.knots,
            span_start_m: f64::from(header.span_start_um) * 1e-6,
            span_end_m: f64::from(header.span_end_um) * 1e-6,
            sample_rate_hz: header.sample_rate_hz,
        }
    }
}

impl CountersInfo {
    fn of(status: &Status) -> Self {
        let Counters { frames, crc_errors, overlong, duplicates, dropped, underruns, clips, max_cycles } =
            status.counters;
        let clipped_samples = clips;
        Self { frames, crc_errors, overlong, duplicates, dropped, underruns, clipped_samples, max_cycles }
    }
}

/// The protocol's name of a value.
fn name(of: &impl Debug) -> String {
    format!("{of:?}")
}
