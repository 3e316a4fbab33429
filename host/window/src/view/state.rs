//! What the views keep from frame to frame: the open pages, typed texts, and each panel's own part.

use super::kept::{Brush, Fields, LogView, PlotsView, Pressing, ResponseView, Seen, Sketched, TypedPath};
use crate::intent::{Intent, Intents};
use eframe::egui;

/// The open page of the side panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Tab {
    #[default]
    Boundary,
    Tones,
    Texture,
    Plate,
    Device,
    Play,
}

impl Tab {
    /// From left to right.
    pub(crate) const ALL: [Self; 6] =
        [Self::Boundary, Self::Tones, Self::Texture, Self::Plate, Self::Device, Self::Play];
}

/// The open page of the tab [`Tab::Plate`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum PlatePage {
    #[default]
    Plate,
    Validity,
    Designer,
    Measure,
}

/// The state of the views themselves: typed texts, the open tab.
#[derive(Default)]
pub(crate) struct ViewState {
    pub(crate) tab: Tab,
    pub(crate) plate_page: PlatePage,
    pub(crate) fields: Fields,
    pub(crate) log: LogView,
    pub(crate) plots: PlotsView,
    /// The breakpoint of the texture's plot that the pointer holds.
    pub(crate) held_breakpoint: Option<usize>,
    pub(crate) focused_handle: Option<egui::Id>,
    pub(crate) focused_finger: Option<egui::Id>,
    /// When egui took the latest input that was processed.
    pub(crate) input_time_s: Option<f64>,
    /// Whether a text field had the focus when the latest frame was shown.
    pub(crate) was_typing: bool,
    /// The press on the plate or the envelope.
    pub(crate) pressing: Pressing,
    /// The brush of the envelope: present while the page Texture is open.
    pub(crate) brush: Brush,
    /// STOP was pressed since the last picture: a Drive of the same picture, before it or after it, is not carried out.
    pub(crate) is_stopped: bool,
    /// Whether the Tab key was pressed while nothing had the focus: it begins with the line.
    pub(crate) begins_by_tab: bool,
    /// The line whose knob was pressed and is still under the pointer.
    pub(crate) pressed_knob: Option<egui::Id>,
    pub(crate) notices: Seen,
    /// Whether the window is shown smaller, because it is low.
    pub(crate) is_shrunk: bool,
    pub(crate) response: ResponseView,
    pub(crate) sketched: Sketched,
    pub(crate) typed_path: Option<TypedPath>,
    /// Where the lights' symbols stand on the stage, in metres: they stay during a drag.
    pub(crate) marks_m: Vec<f64>,
    /// The light whose symbol was pressed, and whether the page is still to be scrolled to it.
    pub(crate) pressed_light: Option<&'static str>,
    pub(crate) scrolls_to_light: bool,
}

impl ViewState {
    /// Opens the validity lights.
    pub(crate) fn open_validity(&mut self, intents: &mut Intents) {
        self.tab = Tab::Plate;
        self.plate_page = PlatePage::Validity;
        self.pressed_light = None;
        // In a small window the plots may be in the panel's place.
        intents.push(Intent::ShowPanel(true));
    }

    /// Opens the validity lights at the row of this one.
    pub(crate) fn open_light(&mut self, name: &'static str, intents: &mut Intents) {
        self.open_validity(intents);
        self.pressed_light = Some(name);
        self.scrolls_to_light = true;
    }

    /// Whether the page of measurements is open: its plots are in the place of the stage.
    pub(crate) fn is_measuring(&self) -> bool {
        self.tab == Tab::Plate && self.plate_page == PlatePage::Measure
    }

    /// Whether the designer is open.
    pub(crate) fn is_designing(&self) -> bool {
        self.tab == Tab::Plate && self.plate_page == PlatePage::Designer
    }
}
