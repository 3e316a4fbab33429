//! What single views keep from frame to frame, as plain data. `ViewState` has one of each; the view that it is for
//! reads and changes it.

use crate::intent::PathQuestion;
use eframe::egui::{Id, Pos2};
use slipline_link::Severity;
use slipline_plate::design::Design;
use std::collections::HashMap;
use std::sync::Arc;

/// The log's drawer, and its filter.
pub(crate) struct LogView {
    /// Whether it is open, over the lower row.
    pub(crate) is_open: bool,
    pub(crate) least: Severity,
    pub(crate) filter: String,
}

impl Default for LogView {
    fn default() -> Self {
        Self { is_open: false, least: Severity::Info, filter: String::new() }
    }
}

/// The state of a shown message.
pub(crate) struct SeenNotice {
    pub(crate) number: u64,
    /// The time at which it was shown first, in seconds of the window's clock.
    pub(crate) since_s: f64,
    /// Whether it is shown in full.
    pub(crate) is_open: bool,
}

/// The messages that are shown.
pub(crate) type Seen = Vec<SeenNotice>;

/// The texts of the fields that are being edited.
#[derive(Default)]
pub(crate) struct Fields {
    pub(crate) texts: HashMap<Id, Typing>,
}

/// The text of a field that is being edited.
pub(crate) struct Typing {
    pub(crate) text: String,
    pub(crate) error: Option<String>,
    /// The value that the field had before typing began.
    pub(crate) over: String,
}

/// A path that is typed, and its question.
pub(crate) struct TypedPath {
    pub(crate) question: PathQuestion,
    pub(crate) text: String,
}

/// The design that is drawn: while another one is made, the latest.
pub(crate) type Sketched = Option<Arc<Design>>;

/// What the lower row shows, by its tabs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum LowerPlot {
    #[default]
    Waveform,
    Spectrum,
    Finger,
    /// The meters, where they have no column beside the plot.
    Meters,
}

/// The state of the plots.
#[derive(Default)]
pub(crate) struct PlotsView {
    /// What the user has chosen; before that a finger has its trace there, as the finger does not change the drive.
    pub(crate) chosen: Option<LowerPlot>,
    /// What is shown.
    pub(crate) open: LowerPlot,
    /// Whether the row is too narrow for a column of meters.
    pub(crate) has_meters_tab: bool,
    /// The content; frozen while the plots are paused.
    pub(crate) shown: Option<PlotsContent>,
    /// The curve that is held to be compared: seconds and share of full scale.
    pub(crate) held_waveform: Option<Vec<[f64; 2]>>,
    /// The spectrum that is held: Hz and dB.
    pub(crate) held_spectrum: Option<Vec<[f64; 2]>>,
    /// Whether the waveform is magnified to fill its plot.
    pub(crate) is_magnified: bool,
    /// Whether the frequency axis is logarithmic.
    pub(crate) is_logarithmic: bool,
}

impl PlotsView {
    /// Opens the plot of this picture.
    pub(crate) fn open(&mut self, has_finger: bool, has_meters_tab: bool) -> LowerPlot {
        let usual = if has_finger { LowerPlot::Finger } else { LowerPlot::Waveform };
        // A column beside the plot has the meters of a row that was narrower.
        let chosen = self.chosen.filter(|chosen| has_meters_tab || *chosen != LowerPlot::Meters);
        (self.open, self.has_meters_tab) = (chosen.unwrap_or(usual), has_meters_tab);
        self.open
    }
}

/// The content of the plots besides the codes.
pub(crate) struct PlotsContent {
    pub(crate) axes: PlotsAxes,
    /// The frequencies that sound, in Hz; at rest the setup's.
    pub(crate) pitches: Vec<f64>,
}

/// The ranges of the plots. They depend on the plate, not on the tone, so that they do not change while a boundary
/// is dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlotsAxes {
    /// Duration of the waveform, in seconds.
    pub(crate) span_s: f64,
    /// The end of the spectrum, in Hz, and its start where the axis is logarithmic.
    pub(crate) top_hz: f64,
    pub(crate) bottom_hz: f64,
}

/// The state of the views of a measured response.
#[derive(Debug)]
pub(crate) struct ResponseView {
    /// Whether the frequency axis is linear.
    pub(crate) is_linear: bool,
    /// What a narrow window shows.
    pub(crate) chosen: ResponsePart,
    /// Width of the Nyquist plot over its height.
    pub(crate) aspect: f64,
}

impl Default for ResponseView {
    fn default() -> Self {
        Self { is_linear: false, chosen: ResponsePart::default(), aspect: 1.0 }
    }
}

/// What a narrow window shows of a measured response one at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ResponsePart {
    #[default]
    Level,
    Phase,
    Nyquist,
}

/// The brush of the stage.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Brush {
    /// Whether a press on the envelope draws.
    pub(crate) is_taken: bool,
    /// The end of the stroke under way: place and RMS displacement, in metres.
    pub(crate) at: Option<(f64, f64)>,
}

impl Brush {
    /// Takes it, or puts it away.
    pub(crate) fn switch(&mut self) {
        *self = Self { is_taken: !self.is_taken, at: None };
    }

    /// Whether a stroke is under way.
    pub(crate) fn is_drawing(&self) -> bool {
        self.at.is_some()
    }
}

/// The latest press on the plate or the envelope, as far as its effect is open.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pressing {
    pub(crate) waits: Option<Press>,
    /// Whether the press under way has taken the line, so that its end is no click.
    pub(crate) has_taken: bool,
    /// Where the pointer was when it brought a line, until it has left the line's knob.
    pub(crate) brought_at: Option<Pos2>,
}

/// A press whose effect is not decided.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Press {
    pub(crate) at: Pos2,
    /// When it began, and when it ended, in seconds.
    pub(crate) began_s: f64,
    pub(crate) ended_s: Option<f64>,
    /// Whether a click came just before it.
    pub(crate) follows_click: bool,
}
