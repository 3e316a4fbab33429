//! What the window shows. Every view takes the [`Scene`] and returns what the user asks for as intents; none sends
//! anything or changes what it shows.
//!
//! ```text
//! top_bar ................................ STOP
//! stage: plate | envelope | strip (one x axis)   side: boundary, tones, plate_panel, device
//! bottom: waveform, spectrum, meters, log
//! ```

mod aligned;
pub mod axis;
mod bottom;
mod boundary;
mod designer;
mod device;
mod dialogs;
mod envelope;
mod field;
pub mod intent;
mod log;
mod meters;
mod notices;
mod plate;
mod plate_panel;
mod plots;
mod side;
mod stage;
mod strip;
pub mod theme;
mod tones;
mod top_bar;
mod validity;

pub(crate) use log::line as log_line;
pub(crate) use stage::arrow_step_m;

use crate::app::{Background, Notice, TableState, Waiting};
use crate::link::{PortInfo, Snapshot};
use crate::live::Live;
use crate::model::Setup;
use crate::picture::Picture;
use crate::settings::Settings;
use crate::sheet::Frame;
use crate::trial::Measured;
use eframe::egui;
use intent::{Dialog, Grab, Intents};

/// Everything the views show.
pub struct Scene<'a> {
    /// What the user has set up.
    pub setup: &'a Setup,
    /// The tone that the boundary panel and the arrow keys are about.
    pub selected: u8,
    /// The tone under the pointer's button.
    pub grab: Option<Grab>,
    /// Link and device.
    pub snapshot: &'a Snapshot,
    /// Whether the user wants the plate driven.
    pub drive_wanted: bool,
    /// The plate under the setup's tones; of unit height while `full_peak_m` is not known.
    pub predicted: &'a Picture,
    /// The plate under the tones that the device has acknowledged and sounds.
    pub sounding: Option<&'a Picture>,
    /// The peak at level 1 in metres; `None` until the table for the plate is made.
    pub full_peak_m: Option<f64>,
    /// The table for the setup's plate.
    pub table: &'a TableState,
    /// The mirror's samples.
    pub live: &'a Live,
    /// The simulated plate under the tones that sound, once it has settled.
    pub measured: Option<&'a Measured>,
    /// The lights, the designer and what the wave is drawn from.
    pub background: &'a Background,
    /// The sheet, if the wave is drawn from it.
    pub sheet: Option<&'a Frame>,
    /// Work that takes long.
    pub waiting: Option<Waiting>,
    /// What is remembered.
    pub settings: &'a Settings,
    /// Ports that exist.
    pub ports: &'a [PortInfo],
    /// Messages to the user.
    pub notices: Vec<&'a Notice>,
    /// The page in front.
    pub dialog: Option<&'a Dialog>,
    /// What undo and redo would do.
    pub undo: (Option<&'static str>, Option<&'static str>),
    /// Seconds of slow motion so far: stands while the wave is paused.
    pub wave_time_s: f64,
}

/// What the views remember themselves: what is typed, which tab is open.
#[derive(Default)]
pub struct ViewState {
    pub(crate) tab: side::Tab,
    pub(crate) plate_page: plate_panel::Page,
    pub(crate) fields: field::Fields,
    pub(crate) log: log::LogView,
    pub(crate) plots: plots::PlotsView,
    pub(crate) focused_handle: Option<egui::Id>,
    pub(crate) notices: notices::Since,
    pub(crate) typed_path: Option<dialogs::TypedPath>,
}

impl ViewState {
    /// Opens a tab by its place, 0..4.
    pub(crate) fn open_tab(&mut self, index: usize) {
        self.tab = side::Tab::by_index(index);
    }

    /// Opens the validity lights.
    fn open_validity(&mut self) {
        self.tab = side::Tab::Plate;
        self.plate_page = plate_panel::Page::Validity;
    }

    /// Whether the focus is on a boundary handle.
    pub(crate) fn is_handle(&self, focused: Option<egui::Id>) -> bool {
        focused.is_some() && self.focused_handle == focused
    }
}

impl Scene<'_> {
    /// The CRC of the table for the plate on the screen.
    fn table_crc(&self) -> Option<u32> {
        self.table.made().map(|made| made.device_table.crc())
    }

    /// Whether the device holds another table than the one for the plate on the screen.
    fn is_table_dirty(&self) -> bool {
        let on_device = self.snapshot.table.active.map(|header| header.crc);
        self.snapshot.is_connected() && self.table_crc().is_some_and(|crc| on_device != Some(crc))
    }

    /// The worst case of the sum of all tones, of the DAC's full scale.
    fn headroom_sum(&self) -> f64 {
        self.table.headroom_sum(self.setup)
    }
}

/// Shows the whole window.
pub fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState) -> Intents {
    let mut intents = Intents::new();
    let palette = theme::palette(ui);
    let frame = theme::panel_frame(palette);
    egui::Panel::top("top")
        .frame(frame)
        .resizable(false)
        .show(ui, |ui| top_bar::show(ui, scene, &mut intents));
    egui::Panel::bottom("bottom").frame(frame).exact_size(bottom::HEIGHT).resizable(false).show(ui, |ui| {
        bottom::show(ui, scene, view, &mut intents);
    });
    egui::Panel::right("side").frame(frame).exact_size(side::WIDTH).resizable(false).show(ui, |ui| {
        side::show(ui, scene, view, &mut intents);
    });
    let page = egui::Frame::new().fill(palette.page).inner_margin(egui::Margin::symmetric(14, 10));
    egui::CentralPanel::no_frame().frame(page).show(ui, |ui| stage::show(ui, scene, view, &mut intents));
    dialogs::show(ui, scene, view, &mut intents);
    intents
}
