//! The texture page: its draft is computed while the page is open, and slow parts once the pointer is up.

use super::brush::Brush;
use super::shown::TextureScene;
use super::{Instrument, Output, Page};
use slipline_model::jobs::texture::{TextureJob, TextureRefused, TextureWish, Textured};
use slipline_model::setup::file as setup_file;
use slipline_model::setup::undo::{EditSource, Gesture};
use slipline_model::setup::{BoundaryMode, edit};
use slipline_model::texture::{Made, WishDraft, WishKind, from_csv, from_png};
use slipline_plate::Plate;
use std::sync::Arc;

/// Signature at the start of PNG files.
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The state of the texture page.
pub(crate) struct Textures {
    draft: WishDraft,
    /// The plate to which the draft's places belong.
    plate: Arc<Plate>,
    /// The latest wish for which a job was requested, and whether that included the slow parts.
    asked: Option<(TextureWish, bool)>,
    pub(crate) latest: Option<Textured>,
    is_given_up: bool,
}

impl Textures {
    pub(crate) fn of(plate: &Arc<Plate>) -> Self {
        let draft = WishDraft::of(plate);
        Self { draft, plate: Arc::clone(plate), asked: None, latest: None, is_given_up: false }
    }

    /// Restarts if the places were those of another plate.
    fn follow_plate(&mut self, plate: &Arc<Plate>) {
        if !Arc::ptr_eq(&self.plate, plate) {
            let WishDraft { kind, most, .. } = self.draft;
            *self = Self::of(plate);
            (self.draft.kind, self.draft.most) = (kind, most);
        }
    }

    pub(crate) fn draft(&mut self, draft: WishDraft) {
        self.draft = draft;
        self.is_given_up = false;
    }

    /// Moves the end of an area that nobody has chosen to where this plate allows it.
    pub(crate) fn suit(&mut self) {
        let is_new = self.draft.felt_edge_m == WishDraft::of(&self.plate).felt_edge_m;
        if let Some(Textured { result: Err(TextureRefused(refused)), .. }) = self.current()
            && is_new
            && let Some(suited) = self.draft.suited(refused)
        {
            self.draft(suited);
        }
    }

    /// Cancels the draft.
    pub(crate) fn give_up(&mut self) {
        self.is_given_up = true;
        self.asked = None;
    }

    /// The texture of the draft, if it is computed.
    fn current(&self) -> Option<&Textured> {
        let (asked, _) = self.asked.as_ref()?;
        self.latest.as_ref().filter(|latest| latest.wish == *asked)
    }

    pub(crate) fn scene(&self, is_drawn: bool) -> TextureScene<'_> {
        TextureScene {
            draft: &self.draft,
            latest: self.latest.as_ref(),
            is_current: self.current().is_some(),
            is_given_up: self.is_given_up,
            is_drawn,
        }
    }
}

impl Instrument {
    /// Requests the texture of the draft while its page is open or it is drawn, and its slow parts once the pointer is up.
    pub(crate) fn update_texture(&mut self) {
        if !self.attention.is_texture_open && !self.brush.is_drawn() {
            return;
        }
        self.textures.follow_plate(&self.setup.plate);
        let Some(table) = self.screen_table().cloned() else { return };
        let draft = &self.textures.draft;
        let wish = TextureWish {
            table,
            wish: draft.wish(),
            level_m: draft.level_m.filter(|_| draft.kind == WishKind::Profile),
            most: draft.most,
            feeling: self.setup.feeling,
        };
        let is_asked = self.textures.asked.as_ref().is_some_and(|(asked, _)| *asked == wish);
        if !is_asked && !self.textures.is_given_up {
            self.textures.asked = Some((wish.clone(), false));
            return self.jobs.textures.ask(TextureJob { wish, begun: None });
        }
        let begun = self.textures.current().filter(|latest| !latest.is_finished);
        let begun = begun.and_then(|latest| latest.result.as_ref().ok()).cloned();
        let is_drawing = self.attention.is_pressed;
        if let (Some(made), Some((_, has_rest @ false))) = (begun, &mut self.textures.asked)
            && !is_drawing
        {
            *has_rest = true;
            self.jobs.textures.ask(TextureJob { wish, begun: Some(made) });
        }
    }

    fn made_texture(&self) -> Option<Arc<Made>> {
        self.textures.current()?.result.as_ref().ok().cloned()
    }

    /// Stores a result of the texture's thread, and has the tones follow it if it is a drawing's.
    pub(crate) fn take_texture(&mut self, textured: Textured) {
        if let Ok(made) = &textured.result
            && textured.wish.level_m.is_some()
            && !textured.is_finished
        {
            self.follow_drawing(&made.edit());
        }
        self.textures.latest = Some(textured);
        self.textures.suit();
    }

    /// Sets the draft of the texture page. Another profile has no level, and is not the one that is drawn over the envelope.
    pub fn draft_texture(&mut self, mut draft: WishDraft) {
        let before = &self.textures.draft;
        if (draft.kind, &draft.profile) != (before.kind, &before.profile) {
            draft.level_m = None;
            self.brush = Brush::default();
        }
        self.textures.draft(draft);
    }

    /// Draws the draft itself, along a path of places and RMS displacements in metres; its tones follow.
    pub fn draw_texture(&mut self, path: &[(f64, f64)]) {
        self.textures.follow_plate(&self.setup.plate);
        let mut draft = self.textures.draft.clone();
        if !self.brush.is_drawn() {
            draft.begin_drawing();
        }
        draft.draw(path, self.setup.plate.length_m());
        self.textures.draft(draft);
        self.brush.begin_stroke(Gesture { source: EditSource::User, number: self.gesture });
    }

    /// Says that a texture moves the lines to turning points, if they are elsewhere.
    pub(crate) fn note_turning_points(&mut self) {
        if self.setup.boundary != BoundaryMode::TurningPoint {
            let text = "The lines are at turning points now: no tone of a texture has a felt edge of its own. \
                        Undo, or \"Line at\" on the page Boundary, takes it back.";
            self.notices.post(text.to_owned());
        }
    }

    /// Puts the computed texture into the setup.
    pub fn play_texture(&mut self) {
        let Some(made) = self.made_texture() else { return };
        self.note_turning_points();
        self.edit(&made.edit());
        let gain_db = made.chord_gain_db().unwrap_or(0.0);
        if gain_db > 0.1 && self.snapshot.is_connected() && self.chord().is_none() {
            let text = format!("This device plays no chords: the texture is {gain_db:.1} dB quieter on it.");
            self.notices.post(text);
        }
    }

    /// Has the shell save the computed texture as a setup.
    pub fn save_texture(&mut self) {
        let Some(made) = self.made_texture() else { return };
        match edit::apply(&self.setup, &made.edit()) {
            Ok(setup) => {
                let text = setup_file::write(&setup);
                self.save("texture.toml", "Setup", "toml", text.into_bytes());
            }
            Err(error) => self.fail(slipline_link::capitalized(&error.to_string())),
        }
    }

    /// Draws the texture from a profile file, and opens its page.
    pub fn take_profile(&mut self, name: &str, bytes: &[u8]) {
        let profile = if bytes.starts_with(PNG_SIGNATURE) {
            from_png(bytes, self.setup.plate.length_m()).map(|breakpoints| (breakpoints, String::new()))
        } else {
            from_csv(bytes).map(|table| (table.breakpoints, format!(": {}", table.read)))
        };
        match profile {
            Ok((breakpoints, read)) => {
                self.textures.follow_plate(&self.setup.plate);
                let mut draft = self.textures.draft.clone();
                draft.take_profile(&breakpoints);
                self.draft_texture(draft);
                self.outputs.push(Output::Open(Page::Texture));
                self.notices.post(format!("Opened {name}{read}"));
            }
            Err(error) => self.not_opened(name, &error),
        }
    }
}
