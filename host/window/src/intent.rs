//! What a view asks for. Views send nothing and change nothing of the device; the app carries intents out.

use crate::axis::Axis;
use crate::settings::ThemeChoice;
use slipline_link::Request;
use slipline_model::export::figures::Format;
use slipline_model::field::sheet::SourceChoice;
use slipline_model::jobs::design::Draft;
use slipline_model::setup::edit::Edit;
use std::path::PathBuf;

/// What was grabbed with the pointer, so that every later move of the pointer is a move of the tone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// The tone.
    pub slot: u8,
    /// The axis it was grabbed on.
    pub axis: Axis,
    /// How far the pointer was from the line when it took it, in points; kept during the drag.
    pub offset: f32,
}

/// What is exported.
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
}

/// Which page stands in front of the window.
#[derive(Clone, Debug, PartialEq)]
pub enum Dialog {
    /// The page of shortcuts.
    Shortcuts,
    /// Help with ports and permissions.
    PortHelp,
    /// Version, licences, where it comes from.
    About,
    /// Versions, counters, setup and log, to be read before they are sent.
    Diagnostics,
    /// Where a file is or shall be, where the system has no dialog for that.
    Path(PathQuestion),
    /// Something real would happen.
    Confirm(Confirm),
}

/// What is asked when a path must be typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathQuestion {
    /// What the path is for, as a title.
    pub title: &'static str,
    /// The word on the button.
    pub verb: &'static str,
    /// The path that is offered.
    pub offered: String,
    /// The path that was typed and names a file that exists: it would be replaced.
    pub existing: Option<String>,
}

/// What needs a confirmation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Confirm {
    /// Unmute a real amplifier.
    Arm,
    /// Overwrite what the device keeps in flash.
    Store,
    /// Erase what the device keeps in flash.
    Forget,
    /// Restart into the bootloader.
    Bootloader,
}

/// One thing a view asks for.
#[derive(Clone, Debug)]
pub enum Intent {
    /// Change the setup.
    Edit(Edit),
    /// Ask the link.
    Request(Request),
    /// Connect to a port.
    Connect(slipline_link::Port),
    /// Drive the tones of the setup.
    Start,
    /// Ramp to silence.
    Stop,
    /// Ramp to silence and mute.
    Disarm,
    /// Make this tone the selected one.
    Select(u8),
    /// The pointer took a handle.
    Grab(Grab),
    /// Take back the latest change.
    Undo,
    /// Do again what was taken back.
    Redo,
    /// Back to one boundary on the first preset.
    New,
    /// Choose a setup or plate file and open it.
    OpenDialog,
    /// Open this file.
    Open(PathBuf),
    /// Choose where to save the setup.
    SaveDialog,
    /// Save the plate alone as a file.
    SavePlateDialog,
    /// Design the plate of this draft.
    Design(Box<Draft>),
    /// Put the designed plate in the setup.
    UseDesign,
    /// Save the designed plate as a plate file.
    SaveDesign,
    /// Save the cut files of the designed plate and its frame.
    SaveCutFiles,
    /// Give up the work that is under way.
    CancelWork,
    /// Make the table whose making was given up.
    MakeTable,
    /// Choose what the wave is drawn from.
    Wave(SourceChoice),
    /// Save what is seen.
    Export(Export),
    /// Send the table for the plate on the screen.
    Upload,
    /// Light, dark or as the system.
    Theme(ThemeChoice),
    /// Show a page, or close it.
    Dialog(Option<Dialog>),
    /// The path was typed; whether a file that exists there may be replaced.
    Path(String, bool),
    /// Carry out what was confirmed.
    Confirmed(Confirm),
    /// The message of this number is read.
    DismissNotice(u64),
    /// Look for ports again.
    RefreshPorts,
    /// Colour the plate by how far it moves at most, or by where it is now.
    ShowAmplitude(bool),
    /// Draw the wave moving, or standing.
    Animate(bool),
    /// Put text on the clipboard.
    Copy(String),
    /// Open the device panel.
    ShowDevice,
    /// Close the window.
    Quit,
    /// Put versions, counters, setup and log on the clipboard, and show them.
    CopyDiagnostics,
}

/// What the views of one frame ask for, in order.
pub type Intents = Vec<Intent>;
