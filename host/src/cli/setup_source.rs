//! The plate of a command and what is to sound on it: by its options, or by a setup file.
//!
//! ```text
//! --plate, --felt-edge, --turning-point --> AskedTones \
//!                                                       --table--> Setup --device's state--> Sounding
//! --setup -------------------------------------> Setup /
//! ```

use super::argument;
use super::failure::Failure;
use super::source::text_of;
use super::tones::{AskedTones, TonesArgument};
use clap::Args;
use slipline_instrument::requests::NamedFeeling;
use slipline_link::{DeviceTable, Snapshot, Sounding};
use slipline_model::setup::file::{self, Opened};
use slipline_model::setup::{Setup, edit};
use slipline_model::texture::{self, chord_of};
use slipline_plate::{DriveTable, Plate};
use std::path::PathBuf;
use std::sync::Arc;

/// The plate and the tones.
#[derive(Debug, Args)]
pub(super) struct SetupArgument {
    /// A preset's name or a TOML file. Without this option: SLIPLINE_PLATE of the environment, else plate = "..." of the
    /// settings file, else membrane.
    #[arg(long, value_name = "PLATE", help_heading = "Plate")]
    plate: Option<String>,
    /// Plate, tones, master level and glide from a setup file, as the app and `slipline texture` write it.
    #[arg(long, value_name = "SETUP.toml", conflicts_with_all = ["plate", "felt_edges", "turning_points", "boundary", "tone", "level", "feeling"])]
    setup: Option<PathBuf>,
    #[command(flatten)]
    tones: TonesArgument,
}

impl SetupArgument {
    /// The plate and the tones, which fit its span as far as that is known without a table.
    pub(super) fn read(&self) -> Result<SetupSource, Failure> {
        let Some(path) = &self.setup else {
            let plate = Arc::new(argument::plate_or_default(self.plate.as_deref())?);
            let asked = self.tones.on(&plate)?;
            return Ok(SetupSource { plate, feeling: asked.feeling.clone(), sounds: Sounds::Tones(asked) });
        };
        let text = text_of(path, file::FILE_BYTES_MAX)?;
        match file::read(&text).map_err(|error| Failure::in_file(path, error))? {
            Opened::Setup(setup) => Ok(SetupSource {
                plate: Arc::clone(&setup.plate),
                feeling: NamedFeeling::of_setup(&setup, path.display().to_string()),
                sounds: Sounds::Setup(setup),
            }),
            Opened::Plate(_) => {
                let why = "a plate alone: name it with --plate, and a --felt-edge or a --turning-point";
                Err(Failure::of_file(path, why))
            }
        }
    }
}

/// The plate, and what is to sound on it.
pub(super) struct SetupSource {
    pub(super) plate: Arc<Plate>,
    pub(super) feeling: NamedFeeling,
    sounds: Sounds,
}

/// What is to sound: a setup of a file, or tones.
enum Sounds {
    Setup(Box<Setup>),
    Tones(AskedTones),
}

impl SetupSource {
    /// Whether it is a setup of a file.
    pub(super) const fn is_of_file(&self) -> bool {
        matches!(self.sounds, Sounds::Setup(_))
    }

    /// Whether a felt edge is asked for.
    pub(super) fn has_felt_edge(&self) -> bool {
        match &self.sounds {
            Sounds::Setup(_) => false,
            Sounds::Tones(asked) => asked.has_felt_edge(),
        }
    }

    /// The setup that sounds; `table` is that of the plate.
    pub(super) fn setup(&self, table: &DriveTable) -> Result<Setup, Failure> {
        match &self.sounds {
            Sounds::Setup(setup) => Ok((**setup).clone()),
            Sounds::Tones(asked) => asked.setup(&self.plate, table),
        }
    }

    /// What is asked of the tones of its setup: the places of options, the turning points of a file.
    pub(super) fn asked(&self) -> AskedTones {
        match &self.sounds {
            Sounds::Setup(setup) => AskedTones::of_setup(setup, self.feeling.clone()),
            Sounds::Tones(asked) => asked.clone(),
        }
    }

    /// What plays the setup on the device of a snapshot, which holds this table: a file's chord if it has one that the
    /// device can play, otherwise its tones, whose sum fits.
    pub(super) fn sounding(
        &self,
        setup: &Setup,
        table: &DeviceTable,
        device: &Snapshot,
    ) -> Result<Sounding, Failure> {
        let sounding = if self.is_of_file() {
            texture::sounding(setup, chord_of(setup, table), table, device).map_err(Failure::refused)?
        } else {
            Sounding::Drive(edit::drive(setup))
        };
        if let Sounding::Drive(_) = sounding {
            table.check_sum(&at_master_level(setup)).map_err(Failure::usage)?;
        }
        Ok(sounding)
    }
}

/// The tones of a setup as (turning point in metres, level at the setup's master level).
pub(super) fn at_master_level(setup: &Setup) -> Vec<(f64, f64)> {
    setup.tones.iter().map(|tone| (tone.position_m, tone.level * setup.master())).collect()
}
