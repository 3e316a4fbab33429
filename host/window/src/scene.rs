//! The scene: everything the views show, as the app passes it to them.

use crate::intent::{Dialog, Grab};
use crate::settings::Settings;
use crate::sound::{SoundChoice, SpeakerState};
use slipline_instrument::Shown;
use slipline_link::{PortInfo, upkeep};
use slipline_model::field::steady_field::{envelope_top_m, full_colour_m};
use slipline_model::scenes::Thumbnail;
use std::ops::Deref;

pub use slipline_instrument::{
    Asked, AskedContent, AskedTable, Background, CalibrateScene, DesignState, HoldScene, LiveScene,
    MeasureScene, Notice, SoFar, TextureScene, Waiting,
};

/// Everything the views show.
pub struct Scene<'a> {
    /// What the instrument shows.
    pub instrument: Shown<'a>,
    /// The object that the pointer drags.
    pub grab: Option<Grab>,
    /// How many times larger than to the table's full scale the stage shows displacements: 1, 2, 5, 10 and so on.
    pub magnification: f64,
    /// A name and a sentence in place of the menus, in a window that shows the stage alone: of the scene that visitors see, or
    /// of the plate in a frame of another page.
    pub stage_alone: Option<(&'a str, &'a str)>,
    /// The present sound.
    pub sound: SoundScene,
    /// The settings that are kept between runs.
    pub settings: &'a Settings,
    /// Ports that exist.
    pub ports: &'a [PortInfo],
    /// The pictures of the scenes; empty until they are drawn.
    pub thumbnails: &'a [Thumbnail],
    /// Whether the window has an address, which can hold a setup: that of a page in a browser.
    pub has_address: bool,
    /// Whether the user must be asked for a board before it is listed: so it is in a browser.
    pub asks_for_port: bool,
    /// The page in front.
    pub dialog: Option<&'a Dialog>,
}

impl<'a> Deref for Scene<'a> {
    type Target = Shown<'a>;

    fn deref(&self) -> &Shown<'a> {
        &self.instrument
    }
}

impl Scene<'_> {
    /// The displacement of full colour, in metres.
    pub(crate) fn full_colour_m(&self) -> f64 {
        full_colour_m(self.sounding, self.full_peak_m.unwrap_or(0.0)) / self.magnification
    }

    /// The top of the envelope's axis, in metres, or of its unit height while the peak at level 1 is not known.
    pub(crate) fn envelope_top_m(&self) -> f64 {
        envelope_top_m(self.predicted, self.full_peak_m.unwrap_or(1.0)) / self.magnification
    }

    /// What the user has to know before this board is armed for the first time, if there is anything.
    pub(crate) fn asks_before_arming(&self) -> Option<&'static str> {
        let unit = self.snapshot.unit()?;
        let level = self.snapshot.device.maintenance.as_ref().and_then(upkeep::before_arming);
        let level = level.filter(|_| !self.settings.unguarded_boards.contains(&unit));
        let lacks_profile =
            self.snapshot.lacks_profile() && !self.settings.boards_without_profile.contains(&unit);
        level.or_else(|| lacks_profile.then_some(upkeep::NO_PROFILE))
    }
}

/// What is heard, and why not.
pub struct SoundScene {
    /// The played sound.
    pub choice: SoundChoice,
    /// The state of the system's sound.
    pub speaker: SpeakerState,
    /// Why the drive, or a part of it, is not played.
    pub unplayed: Option<String>,
}
