//! Recording and replay of a drag. A replay follows the path of a drag: each move is an edit within the same
//! limits, and is sent only if the plate is driven already. It does not arm the device, and the end of the
//! drive ends it.

use super::Desk;
use crate::instrument::outbox::Outbox;
use crate::recording::{Move, Recording};
use slipline_model::field::line;
use slipline_model::setup::undo::{EditSource, Gesture};
use slipline_plate::DriveTable;
use std::time::Duration;

/// Time between two moves of a replay.
const STEP: Duration = Duration::from_millis(16);
/// Frame intervals longer than this, in seconds, are not counted, so that a hidden window does not jump
/// ahead.
const GAP_S: f64 = 0.1;

/// The recorder: the recording, and whether it is recorded or played.
#[derive(Debug, Default)]
pub struct DragRecorder {
    recording: Recording,
    /// While it records: the time of the first move, if there was one.
    begun: Option<Option<f64>>,
    playing: Option<Playing>,
    /// The time that the lines were moved to, in seconds: the next replay begins there.
    rests_at_s: Option<f64>,
    /// The gesture by which a time was chosen last.
    sought: Option<u64>,
    /// Number of replays and choices of a time so far: each is a gesture.
    plays: u64,
    /// Whether the replay repeats from its start.
    pub is_looped: bool,
}

/// A replay under way.
#[derive(Debug)]
struct Playing {
    /// Time played, in seconds; negative before the first move.
    done_s: f64,
    /// The time of the last frame, in seconds of the window's clock.
    last_s: Option<f64>,
    /// Whether the plate was driven meanwhile: then the end of the drive ends the replay.
    has_driven: bool,
}

impl DragRecorder {
    /// The recording.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Whether moves are recorded.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.begun.is_some()
    }

    /// Time played, in seconds, while it plays.
    #[must_use]
    pub fn played_s(&self) -> Option<f64> {
        self.playing.as_ref().map(|playing| playing.done_s.max(0.0))
    }

    /// The time at which the recording stands, in seconds: the time played, or the one that was chosen.
    #[must_use]
    pub fn head_s(&self) -> Option<f64> {
        self.played_s().or(self.rests_at_s)
    }
}

impl Desk {
    /// Begins a new recording, or ends it.
    pub(crate) fn record(&mut self, records: bool, out: &mut Outbox) {
        self.end_replay();
        if records {
            self.take_recording(Recording::default());
            out.post("Recording begins with the first move of a line.".to_owned());
        }
        self.recorder.begun = records.then_some(None);
    }

    /// Replaces the recording by one from a file.
    pub(crate) fn take_recording(&mut self, recording: Recording) {
        self.end_replay();
        self.recorder.begun = None;
        self.recorder.rests_at_s = None;
        self.recorder.recording = recording;
    }

    /// Begins the replay, or ends it.
    pub fn play(&mut self, plays: bool) {
        self.recorder.begun = None;
        self.recorder.plays += 1;
        let DragRecorder { recording, playing, rests_at_s, .. } = &mut self.recorder;
        let begin_s = rests_at_s.take().filter(|begin_s| *begin_s < recording.duration_s());
        *playing = (plays && !recording.moves().is_empty()).then_some(Playing {
            done_s: begin_s.unwrap_or(-1.0),
            last_s: None,
            has_driven: false,
        });
    }

    /// Sets whether the replay repeats from its start.
    pub const fn loop_replay(&mut self, is_looped: bool) {
        self.recorder.is_looped = is_looped;
    }

    /// Ends the replay, because the drive was stopped or the user takes a line.
    pub fn end_replay(&mut self) {
        self.recorder.playing = None;
    }

    /// Chooses a time of the recording, in seconds, from which a replay goes on; returns the moves that put the lines there.
    pub(crate) fn seek(&mut self, time_s: f64) -> Option<impl Iterator<Item = Move> + use<>> {
        if self.recorder.is_recording() || !time_s.is_finite() {
            return None;
        }
        let time_s = time_s.clamp(0.0, self.recorder.recording.duration_s());
        if self.recorder.sought.replace(self.gesture) != Some(self.gesture) {
            self.recorder.plays += 1;
        }
        match &mut self.recorder.playing {
            Some(playing) => (playing.done_s, playing.last_s) = (time_s, None),
            None => self.recorder.rests_at_s = Some(time_s),
        }
        Some(self.recorder.recording.between(-1.0, time_s))
    }

    /// The gesture of the present replay.
    pub(crate) const fn replay_gesture(&self) -> Gesture {
        Gesture { source: EditSource::Recording, number: self.recorder.plays }
    }

    /// The moves of a replay that are due now, in seconds of the user's time.
    pub(crate) fn due_moves(
        &mut self,
        now_s: f64,
        is_driven: bool,
        out: &mut Outbox,
    ) -> Option<impl Iterator<Item = Move> + use<>> {
        let DragRecorder { recording, playing, is_looped, .. } = &mut self.recorder;
        let play = playing.as_mut()?;
        if play.has_driven && !is_driven {
            *playing = None;
            out.post("The replay ended with the drive.".to_owned());
            return None;
        }
        play.has_driven |= is_driven;
        let step_s = play.last_s.map_or(0.0, |last_s| (now_s - last_s).clamp(0.0, GAP_S));
        play.last_s = Some(now_s);
        let from_s = play.done_s;
        let to_s = from_s.max(0.0) + step_s;
        play.done_s = to_s;
        if to_s >= recording.duration_s() {
            if *is_looped {
                play.done_s = -1.0;
            } else {
                *playing = None;
            }
        }
        out.wake_after(STEP);
        Some(recording.between(from_s, to_s))
    }

    /// Records that the user has moved a line through these places, in metres, as far as its range allows.
    pub(crate) fn note_moves(
        &mut self,
        slot: u8,
        places_m: &[f64],
        table: Option<&DriveTable>,
        now_s: f64,
        out: &mut Outbox,
    ) {
        let Some(tone) = self.setup.tone(slot).filter(|_| self.recorder.is_recording()) else { return };
        let (low_m, high_m) = line::limits_m(&self.setup, tone, table);
        for place_m in places_m.iter().filter(|place_m| place_m.is_finite()) {
            self.note_move(slot, place_m.max(low_m).min(high_m), now_s, out);
        }
    }

    /// Records that the user has moved a line.
    pub(crate) fn note_move(&mut self, slot: u8, place_m: f64, now_s: f64, out: &mut Outbox) {
        let Some(begun_s) = &mut self.recorder.begun else { return };
        if !self.recorder.recording.push(now_s, begun_s, slot, place_m) {
            self.recorder.begun = None;
            out.fail("The recording is full: it is kept up to here.".to_owned());
        }
    }
}
