//! The requests of the views. Views send nothing and change nothing on the device; the app carries out their
//! intents.

pub use slipline_instrument::{CalibrateIntent, DeviceIntent, MeasureDraft, MeasureIntent};

use crate::axis::Axis;
use crate::settings::ThemeChoice;
use crate::sound::SoundChoice;
use slipline_link::protocol::profile::ActuatorProfile;
use slipline_model::export::figures::Format;
use slipline_model::field::sheet::SourceChoice;
use slipline_model::field::touch::Touch;
use slipline_model::jobs::design::Draft;
use slipline_model::setup::edit::Edit;
use slipline_model::texture::WishDraft;
use std::path::PathBuf;

/// What the pointer drags on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dragged {
    /// The boundary of the tone in this slot.
    Tone(u8),
    /// The finger.
    Finger,
}

/// A drag: every later move of the pointer moves what it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// What is dragged.
    pub held: Dragged,
    /// The axis it was grabbed on.
    pub axis: Axis,
    /// Distance of the pointer from the line at the start of the drag, in points; it stays constant.
    pub offset: f32,
}

/// An export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Export {
    /// Plate, envelope and boundaries as a figure for print.
    Figure(Format),
    /// The window as it looks, as PNG.
    Screenshot,
    /// The envelope over x (and the simulated one), as CSV.
    Envelope,
    /// The drive waveform in the plot, as CSV.
    Waveform,
    /// The drive as sound, as WAV.
    Sound,
    /// Versions, counters, setup and log, as text in a file.
    Diagnostics,
    /// The recorded drag, as CSV.
    Recording,
}

/// The page in front of the window.
#[derive(Clone, Debug, PartialEq)]
pub enum Dialog {
    /// The scenes to start from.
    Scenes,
    /// The page of shortcuts.
    Shortcuts,
    /// Help with ports and permissions.
    PortHelp,
    /// Version, licences and origin.
    About,
    /// Versions, counters, setup and log, for the user to read before sending them.
    Diagnostics,
    /// The calibration.
    Calibrate,
    /// The board's test of itself.
    Selftest,
    /// A path to be typed, on a system without a file dialog.
    Path(PathQuestion),
    /// An action with a real effect must be confirmed.
    Confirm(Confirm),
    /// Whether this profile of an actuator is written to the board, while its user button is held.
    Profile(Box<ActuatorProfile>),
}

/// The question for a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathQuestion {
    /// What the path is for, as a title.
    pub title: &'static str,
    /// The word on the button.
    pub verb: &'static str,
    /// The path that is offered.
    pub offered: String,
    /// The typed path if its file exists and would be replaced.
    pub existing: Option<String>,
}

/// An action that needs a confirmation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Confirm {
    /// Unmute a real amplifier.
    Arm,
    /// Overwrite the data in the device's flash.
    Store,
    /// Erase the data in the device's flash.
    Forget,
    /// Restart into the bootloader.
    Bootloader,
    /// Write the brown-out level into the chip's option bytes.
    BrownOutLevel,
}

/// A request of a view.
#[derive(Clone, Debug)]
pub enum Intent {
    /// Change the setup.
    Edit(Edit),
    /// Move the line of the tone in this slot to this place, in metres from the driven end.
    MoveLine {
        /// Which tone.
        slot: u8,
        /// The place of its line.
        place_m: f64,
    },
    /// Something that is asked of the device itself.
    Device(DeviceIntent),
    /// Connect to a port.
    Connect(slipline_link::Port),
    /// Drive the tones of the setup.
    Start,
    /// Play the tones with companions that cancel the drive's harmonics, until they change.
    CancelHarmonics,
    /// STOP was pressed: ramp to silence, and disarm a real device; pressed twice within a second, an emergency stop.
    Stop,
    /// A key of STOP was pressed: as STOP, but two presses on a simulated device that is silent are no emergency stop.
    StopKey,
    /// Ramp to silence and mute.
    Disarm,
    /// Switch the level hold on or off.
    HoldLevel(bool),
    /// Let held tones rise this far above the drive's levels, in dB.
    MaxRise(f64),
    /// Select this tone.
    Select(u8),
    /// Put this finger on the plate, or take it off.
    Touch(Touch),
    /// Move the finger to this place, in metres from the driven end.
    MoveFinger(f64),
    /// Choose what is heard.
    Sound(SoundChoice),
    /// Set the volume of what is heard, 0..=1.
    Volume(f32),
    /// The pointer took a handle.
    Grab(Grab),
    /// Show the other of the two setups that are compared.
    Switch,
    /// Record the moves of the lines, or end that.
    Record(bool),
    /// Play the recording, or end that.
    Play(bool),
    /// Move the lines to where the recording has them at this time, in seconds.
    Seek(f64),
    /// Play the recording again and again.
    Loop(bool),
    /// Show the wave at this multiple of its usual speed.
    Speed(f64),
    /// Show the paused wave at this time, in seconds of the plate.
    Scrub(f64),
    /// Show the plate before the latest calibration, or the calibrated one again.
    BeforeOrAfter,
    /// Undo the latest change.
    Undo,
    /// Redo the change that was undone.
    Redo,
    /// Back to the first scene.
    New,
    /// Start with the scene of this number.
    StartScene(usize),
    /// Choose a setup or plate file and open it.
    OpenDialog,
    /// Open this file.
    Open(PathBuf),
    /// Choose where to save the setup.
    SaveDialog,
    /// Save the plate alone as a file.
    SavePlateDialog,
    /// Copy the address of the page with the setup in it.
    Share,
    /// Design the plate of this draft.
    Design(Box<Draft>),
    /// Put the designed plate in the setup.
    UseDesign,
    /// Save the designed plate as a plate file.
    SaveDesign,
    /// Save the cut files of the designed plate and its frame.
    SaveCutFiles,
    /// Make the texture of this draft.
    Texture(Box<WishDraft>),
    /// Draw the texture along these places and RMS displacements, in metres.
    Draw(Vec<(f64, f64)>),
    /// The next stroke begins another drawing.
    EndDrawing,
    /// Play the texture that was made.
    PlayTexture,
    /// Save the texture that was made as a setup.
    SaveTexture,
    /// Choose a profile and draw the texture by it.
    OpenProfile,
    /// Something on the page of measurements.
    Measure(MeasureIntent),
    /// Something on the calibration's pages.
    Calibrate(CalibrateIntent),
    /// Compute the plate on the screen in two dimensions.
    CheckPlane,
    /// Cancel the work in progress.
    CancelWork,
    /// Compute the table whose computation was cancelled.
    MakeTable,
    /// Choose the source from which the wave is drawn.
    Wave(SourceChoice),
    /// Export something.
    Export(Export),
    /// Send the table for the plate on the screen.
    Upload,
    /// Light, dark or as the system.
    Theme(ThemeChoice),
    /// Show a page, or close it.
    Dialog(Option<Dialog>),
    /// The path was typed; the flag says whether an existing file may be replaced.
    Path(String, bool),
    /// Carry out what was confirmed.
    Confirmed(Confirm),
    /// Write this profile of an actuator to the board.
    WriteProfile(Box<ActuatorProfile>),
    /// Dismiss the message with this number.
    DismissNotice(u64),
    /// Look for ports again.
    RefreshPorts,
    /// Choose a board in the browser's own list.
    AskForPort,
    /// Colour the plate by its largest displacement, or by the present one.
    ShowAmplitude(bool),
    /// Show the plate in relief, or flat.
    ShowRelief(bool),
    /// Show the panel at the right, or give its room to the stage.
    ShowPanel(bool),
    /// Show the row of plots, or give its room to the stage.
    ShowPlots(bool),
    /// Animate the wave, or pause it.
    Animate(bool),
    /// Put text on the clipboard.
    Copy(String),
    /// Open the device panel.
    ShowDevice,
    /// Show the demonstration again.
    Demonstrate,
    /// Begin the tour.
    BeginTour,
    /// The tour's next step, or its end after the last.
    NextStep,
    /// The tour's step before.
    StepBack,
    /// End the tour.
    EndTour,
    /// Close the window.
    Quit,
    /// Put versions, counters, setup and log on the clipboard, and show them.
    CopyDiagnostics,
}

/// The requests of all views in one frame, in order.
pub type Intents = Vec<Intent>;

/// A control that makes a request.
pub(crate) trait Asks {
    /// Makes the request when the control is pressed.
    fn asks(self, intents: &mut Intents, intent: Intent);
}

impl Asks for eframe::egui::Response {
    fn asks(self, intents: &mut Intents, intent: Intent) {
        if self.clicked() {
            intents.push(intent);
        }
    }
}
