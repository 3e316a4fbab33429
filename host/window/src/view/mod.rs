//! The views of the window. Every view takes the [`Scene`] and returns the user's requests as intents; no view
//! sends anything or changes the state it shows.
//!
//! ```text
//! top_bar ................................ STOP
//! stage: plate, envelope, felt_strip (one x axis)   side_panel: boundary, tones, plate, device, play
//!    or response: level, phase, residual, Nyquist
//! bottom_row: plots (waveform or finger_trace, spectrum), meters, log
//! ```

mod aligned;
mod bottom_row;
mod boundary_panel;
mod designer;
mod device_panel;
mod dialogs;
mod displacement;
mod drive_fields;
mod envelope;
mod feeling_fields;
mod felt_strip;
mod field;
mod finger;
mod finger_trace;
mod foreign_form;
mod handle;
mod hold_fields;
mod light_marks;
mod log;
mod measure_form;
mod measure_panel;
mod menu;
mod meters;
mod notices;
mod offers;
mod place_field;
mod plane_check;
mod plate;
mod plate_panel;
mod play_panel;
mod plots;
mod polyline;
mod read_out;
mod relief;
mod response;
mod room;
mod sensor_fields;
mod side_panel;
mod slider;
mod sound;
mod stage;
mod texture_panel;
mod texture_plot;
pub mod theme;
mod tones_panel;
mod top_bar;
mod validity;

pub(crate) use stage::arrow_step_m;

use crate::intent::{Intent, Intents};
use crate::scene::Scene;
use eframe::egui;

/// The state of the views themselves: typed texts, the open tab.
#[derive(Default)]
pub struct ViewState {
    pub(crate) tab: side_panel::Tab,
    pub(crate) plate_page: plate_panel::Page,
    pub(crate) fields: field::Fields,
    pub(crate) log: log::LogView,
    pub(crate) plots: plots::PlotsView,
    /// The breakpoint of the texture's plot that the pointer holds.
    pub(crate) held_breakpoint: Option<usize>,
    pub(crate) focused_handle: Option<egui::Id>,
    pub(crate) focused_finger: Option<egui::Id>,
    pub(crate) notices: notices::Seen,
    pub(crate) response: response::ResponseView,
    pub(crate) sketched: designer::sketch::Sketched,
    pub(crate) typed_path: Option<dialogs::TypedPath>,
    /// Where the lights' symbols stand on the stage, in metres: they stay during a drag.
    pub(crate) marks_m: Vec<f64>,
    /// The light whose symbol was pressed, and whether the page is still to be scrolled to it.
    pub(crate) pressed_light: Option<&'static str>,
    pub(crate) scrolls_to_light: bool,
}

impl ViewState {
    /// Opens a tab by its place, 0..6.
    pub(crate) fn open_tab(&mut self, index: usize) {
        self.tab = side_panel::Tab::by_index(index);
    }

    /// Opens the device panel.
    pub(crate) fn open_device(&mut self) {
        self.tab = side_panel::Tab::Device;
    }

    /// Opens the texture page.
    pub(crate) fn open_texture(&mut self) {
        self.tab = side_panel::Tab::Texture;
    }

    /// Whether the texture page is open.
    pub(crate) fn is_texture_open(&self) -> bool {
        self.tab == side_panel::Tab::Texture
    }

    /// Opens the validity lights.
    fn open_validity(&mut self, intents: &mut Intents) {
        self.tab = side_panel::Tab::Plate;
        self.plate_page = plate_panel::Page::Validity;
        self.pressed_light = None;
        // In a small window the plots may be in the panel's place.
        intents.push(Intent::ShowPanel(true));
    }

    /// Opens the validity lights at the row of this one.
    fn open_light(&mut self, name: &'static str, intents: &mut Intents) {
        self.open_validity(intents);
        self.pressed_light = Some(name);
        self.scrolls_to_light = true;
    }

    /// Opens the page of measurements.
    pub(crate) fn open_measure(&mut self) {
        self.tab = side_panel::Tab::Plate;
        self.plate_page = plate_panel::Page::Measure;
    }

    /// Whether the page of measurements is open: its plots are in the place of the stage.
    pub(crate) fn is_measuring(&self) -> bool {
        self.tab == side_panel::Tab::Plate && self.plate_page == plate_panel::Page::Measure
    }

    /// Whether the designer is open.
    fn is_designing(&self) -> bool {
        self.tab == side_panel::Tab::Plate && self.plate_page == plate_panel::Page::Designer
    }

    /// Whether the focus is on the finger.
    pub(crate) fn is_finger(&self, focused: Option<egui::Id>) -> bool {
        focused.is_some() && self.focused_finger == focused
    }

    /// Whether the focus is on a boundary handle.
    pub(crate) fn is_handle(&self, focused: Option<egui::Id>) -> bool {
        focused.is_some() && self.focused_handle == focused
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
    let size = ui.ctx().content_rect().size();
    let room = room::Room::of(size, scene.settings, !scene.notices.is_empty());
    room.switch(ui, frame, &mut intents);
    if room.plots {
        egui::Panel::bottom("bottom")
            .frame(frame)
            .exact_size(bottom_row::height(ui))
            .resizable(false)
            .show(ui, |ui| bottom_row::show(ui, scene, view, &mut intents));
    }
    if room.panel {
        egui::Panel::right("side")
            .frame(frame)
            .exact_size(side_panel::WIDTH)
            .resizable(false)
            .show(ui, |ui| side_panel::show(ui, scene, view, &mut intents));
    }
    let page = egui::Frame::new().fill(palette.page).inner_margin(egui::Margin::symmetric(14, 10));
    egui::CentralPanel::no_frame().frame(page).show(ui, |ui| {
        if view.is_measuring() {
            response::show(ui, scene, view);
        } else {
            stage::show(ui, scene, view, &mut intents);
        }
    });
    dialogs::show(ui, scene, view, &mut intents);
    intents
}
