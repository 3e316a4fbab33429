//! `slipline drive --stdin`: a drive that follows lines while it sounds.
//!
//! ```text
//! line --> AskedTones, Setup --refused--> one line on standard error, nothing changes
//!                             \--> the next drive, to which the device glides
//! ```

use super::device::Device;
use super::failure::Failure;
use super::input_lines::Line;
use super::output;
use super::setup_source::at_master_level;
use super::tones::{self, AskedTones};
use serde_json::json;
use slipline_instrument::native::ClientError;
use slipline_link::{DeviceTable, Sounding};
use slipline_model::answer::ToneAnswer;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::{Setup, edit};
use slipline_plate::DriveTable;
use slipline_plate::quantity::show_si;

/// A drive and what is asked of its tones.
pub(super) struct FollowedDrive<'a> {
    device: &'a Device,
    plate_table: &'a DriveTable,
    table: &'a DeviceTable,
    asked: AskedTones,
    setup: Setup,
    /// Number of lines until now.
    lines: u64,
    as_json: bool,
}

impl<'a> FollowedDrive<'a> {
    /// The drive of a setup that sounds.
    pub(super) const fn new(
        device: &'a Device,
        (plate_table, table): (&'a DriveTable, &'a DeviceTable),
        asked: AskedTones,
        setup: Setup,
        as_json: bool,
    ) -> Self {
        Self { device, plate_table, table, asked, setup, lines: 0, as_json }
    }

    /// Both places of the tones that sound; `None` before the first line.
    pub(super) fn places(&self) -> Option<Vec<TonePlaces>> {
        (self.lines > 0).then(|| TonePlaces::of_setup(&self.setup, self.plate_table))
    }

    /// Follows a line; returns whether the drive goes on. A line that is refused is reported and changes nothing.
    pub(super) fn follow(&mut self, text: &str) -> Result<bool, Failure> {
        self.lines += 1;
        let line = match Line::read(text) {
            Ok(None) => return Ok(true),
            Ok(Some(Line::Stop)) => return Ok(false),
            Ok(Some(line)) => line,
            Err(refusal) => return Ok(self.refused(&refusal)),
        };
        let (asked, setup, table) = (self.asked.clone(), &self.setup, self.plate_table);
        let changed = self.device.during(|| changed(&line, asked, setup, table))?;
        let (asked, setup) = match changed {
            Ok(changed) => changed,
            Err(refusal) => return Ok(self.refused(&refusal)),
        };
        let sounds = !matches!(line, Line::Glide(_));
        if sounds {
            if let Err(refusal) = self.table.check_sum(&at_master_level(&setup)) {
                return Ok(self.refused(&Failure::usage(refusal)));
            }
            match self.device.play(Sounding::Drive(edit::drive(&setup))) {
                Ok(at) => self.report(&setup, at)?,
                Err(ClientError::Refused(refusal)) => return Ok(self.refused(&Failure::failed(refusal))),
                Err(error) => return Err(error.into()),
            }
        }
        (self.asked, self.setup) = (asked, setup);
        Ok(true)
    }

    /// Reports a line that changes nothing; the drive goes on.
    fn refused(&self, refusal: &Failure) -> bool {
        let line = self.lines;
        if self.as_json {
            let mut value = refusal.json();
            value["line"] = json!(line);
            output::note(format_args!("{value}"));
        } else {
            output::note(format_args!("slipline: line {line}: {refusal}"));
        }
        true
    }

    /// Reports the drive that begins at `at`.
    fn report(&self, setup: &Setup, at: u64) -> Result<(), Failure> {
        let table = self.plate_table;
        let places = self.device.during(|| TonePlaces::of_setup(setup, table))?;
        let tones: Vec<_> = TonePlaces::on_device(&places, self.table).collect();
        let value = json!({
            // JSON, count: Number of the line of --stdin
            "line": self.lines,
            "at_samples": at,
            // JSON: Time of the change to these tones
            "glide_s": setup.glide_s,
            "tones": tones.iter().map(|(tone, hz)| ToneAnswer::of(tone, *hz)).collect::<Vec<_>>(),
        });
        output::print(self.as_json, &value, |out| {
            let glide = show_si(setup.glide_s, "s");
            writeln!(out, "Line {}: in {glide} to", self.lines)?;
            tones.iter().try_for_each(|(tone, hz)| writeln!(out, "  {}", tones::words(tone, *hz)))
        })
    }
}

/// What is asked and what sounds after a line.
fn changed(
    line: &Line,
    asked: AskedTones,
    setup: &Setup,
    table: &DriveTable,
) -> Result<(AskedTones, Setup), Failure> {
    let asked = match line {
        Line::Places(kind, places) => asked.moved(&setup.plate, *kind, places)?,
        Line::Levels(levels) => asked.at_levels(levels)?,
        Line::Glide(glide_s) => return Ok((asked, Setup { glide_s: *glide_s, ..setup.clone() })),
        Line::Stop => asked,
    };
    let setup = asked.after(setup, table)?;
    Ok((asked, setup))
}
