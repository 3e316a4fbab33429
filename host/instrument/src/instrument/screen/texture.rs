//! The texture page: its draft is computed while the page is open, and slow parts once the pointer is up.

use super::brush::Brush;
use super::{Screen, Sight};
use crate::instrument::outbox::Outbox;
use crate::instrument::shell::Page;
use crate::instrument::shown::TextureScene;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::texture::{TextureJob, TextureRefused, TextureWish, Textured};
use slipline_model::setup::edit::Edit;
use slipline_model::setup::undo::Gesture;
use slipline_model::texture::{Made, WishDraft, WishKind, from_csv, from_png};
use slipline_plate::Plate;
use std::sync::Arc;

/// Signature at the start of PNG files.
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The state of the texture page.
pub(super) struct Textures {
    draft: WishDraft,
    /// The plate to which the draft's places belong.
    plate: Arc<Plate>,
    /// The latest wish for which a job was requested, and whether that included the slow parts.
    asked: Option<(TextureWish, bool)>,
    latest: Option<Textured>,
    is_given_up: bool,
    queue: JobQueue<TextureJob, Textured>,
}

impl Textures {
    pub(super) fn of(plate: &Arc<Plate>, queue: JobQueue<TextureJob, Textured>) -> Self {
        let draft = WishDraft::of(plate);
        Self { draft, plate: Arc::clone(plate), asked: None, latest: None, is_given_up: false, queue }
    }

    /// Begins again if the places were those of another plate.
    fn follow_plate(&mut self, plate: &Arc<Plate>) {
        if !Arc::ptr_eq(&self.plate, plate) {
            let WishDraft { kind, most, .. } = self.draft;
            *self = Self::of(plate, std::mem::take(&mut self.queue));
            (self.draft.kind, self.draft.most) = (kind, most);
        }
    }

    fn draft(&mut self, draft: WishDraft) {
        self.draft = draft;
        self.is_given_up = false;
    }

    /// Moves the end of an area that nobody has chosen to where this plate allows it.
    fn suit(&mut self) {
        let is_new = self.draft.felt_edge_m == WishDraft::of(&self.plate).felt_edge_m;
        if let Some(Textured { result: Err(TextureRefused(refused)), .. }) = self.current()
            && is_new
            && let Some(suited) = self.draft.suited(refused)
        {
            self.draft(suited);
        }
    }

    /// Cancels the draft.
    pub(super) fn give_up(&mut self) {
        self.queue.cancel();
        self.is_given_up = true;
        self.asked = None;
    }

    /// The texture of the draft, if it is computed.
    fn current(&self) -> Option<&Textured> {
        let (asked, _) = self.asked.as_ref()?;
        self.latest.as_ref().filter(|latest| latest.wish == *asked)
    }

    pub(super) fn scene(&self, is_drawn: bool) -> TextureScene<'_> {
        TextureScene {
            draft: &self.draft,
            latest: self.latest.as_ref(),
            is_current: self.current().is_some(),
            is_given_up: self.is_given_up,
            is_drawn,
            reached: self.reached(),
        }
    }

    /// The share of the drawn height that the tones of the latest result can reach, 0 to 1.
    fn reached(&self) -> f64 {
        let drawn =
            self.latest.as_ref().filter(|latest| latest.wish.level_m.is_some_and(|level_m| level_m > 0.0));
        let share = drawn.and_then(|latest| {
            let fitted = latest.result.as_ref().ok()?.fitted.as_ref()?;
            let reached_m = fitted.texture.wanted_m.iter().copied().fold(0.0, f64::max);
            Some(reached_m / latest.wish.level_m?)
        });
        share.map_or(1.0, |share| share.clamp(0.0, 1.0))
    }

    /// The share of the work that is done, 0..=1, while it is under way.
    pub(super) fn progress(&self) -> Option<f32> {
        self.queue.progress()
    }

    /// Stores a result; returns its texture if it is the first of a drawing's.
    pub(super) fn take_result(&mut self) -> Option<Option<Arc<Made>>> {
        let textured = self.queue.take()?;
        let is_drawing = textured.wish.level_m.is_some() && !textured.is_finished;
        let made = textured.result.as_ref().ok().filter(|_| is_drawing).cloned();
        self.latest = Some(textured);
        self.suit();
        Some(made)
    }

    /// Requests the texture of the draft, and its slow parts once the pointer is up.
    fn ask(&mut self, sight: Sight<'_>) {
        let setup = sight.desk.setup();
        self.follow_plate(&setup.plate);
        let Some(table) = sight.drive.table_made().cloned() else { return };
        let draft = &self.draft;
        let wish = TextureWish {
            table,
            wish: draft.wish(),
            level_m: draft.level_m.filter(|_| draft.kind == WishKind::Profile),
            most: draft.most,
            feeling: setup.feeling,
        };
        let is_asked = self.asked.as_ref().is_some_and(|(asked, _)| *asked == wish);
        if !is_asked && !self.is_given_up {
            self.asked = Some((wish.clone(), false));
            return self.queue.ask(TextureJob { wish, begun: None });
        }
        let begun = self.current().filter(|latest| !latest.is_finished);
        let begun = begun.and_then(|latest| latest.result.as_ref().ok()).cloned();
        if let (Some(made), Some((_, has_rest @ false))) = (begun, &mut self.asked)
            && !sight.attention.is_pressed
        {
            *has_rest = true;
            self.queue.ask(TextureJob { wish, begun: Some(made) });
        }
    }
}

impl Screen {
    /// Requests the texture of the draft while its page is open or it is drawn.
    pub(super) fn update_texture(&mut self, sight: Sight<'_>) {
        if sight.attention.is_texture_open || self.brush.is_drawn() {
            self.textures.ask(sight);
        }
    }

    /// The texture of the draft, if it is computed.
    pub(crate) fn made_texture(&self) -> Option<&Arc<Made>> {
        self.textures.current()?.result.as_ref().ok()
    }

    /// The edit by which the setup follows a drawing whose fit this is, as a part of its latest stroke.
    pub(super) fn drawn_edit(&self, made: &Made) -> Option<(Gesture, Edit)> {
        Some((self.brush.stroke()?, made.edit()))
    }

    /// Sets the draft of the texture page. Another profile has no level, and is not the one that is drawn over the envelope.
    pub fn draft_texture(&mut self, mut draft: WishDraft) {
        let before = &self.textures.draft;
        if (draft.kind, &draft.profile) != (before.kind, &before.profile) {
            draft.level_m = None;
            self.end_drawing();
        }
        self.textures.draft(draft);
    }

    /// Draws the draft itself, along a path of places and RMS displacements in metres; its tones follow. A new stroke goes on from
    /// the height that the strokes before have reached, as it is shown.
    pub(crate) fn draw_texture(&mut self, path: &[(f64, f64)], gesture: Gesture) {
        self.textures.follow_plate(&self.plate);
        let mut draft = self.textures.draft.clone();
        if !self.brush.is_drawn() {
            draft.begin_drawing();
        } else if self.brush.stroke() != Some(gesture) && self.textures.current().is_some() {
            draft.level_m = draft.level_m.map(|level_m| level_m * self.textures.reached());
        }
        draft.draw(path, self.plate.length_m());
        self.textures.draft(draft);
        self.brush.begin_stroke(gesture);
    }

    /// Forgets the drawing: the next stroke begins another one.
    pub fn end_drawing(&mut self) {
        self.brush = Brush::default();
    }

    /// Whether the newest tones of a drawing are to be sent now, to a plate that is driven or not.
    pub(crate) fn is_drawing_due(&mut self, now_s: f64, is_driven: bool, out: &mut Outbox) -> bool {
        self.brush.is_due(now_s, is_driven, out)
    }

    /// Draws the texture from a profile file, and opens its page.
    pub(crate) fn take_profile(&mut self, name: &str, bytes: &[u8], out: &mut Outbox) {
        let profile = if bytes.starts_with(PNG_SIGNATURE) {
            let from = "from the brightness of its middle row".to_owned();
            from_png(bytes, self.plate.length_m()).map(|breakpoints| (breakpoints, from))
        } else {
            from_csv(bytes).map(|table| (table.breakpoints, table.read.to_string()))
        };
        match profile {
            Ok((breakpoints, read)) => {
                self.textures.follow_plate(&self.plate);
                let mut draft = self.textures.draft.clone();
                draft.take_profile(&breakpoints);
                self.draft_texture(draft);
                out.open(Page::Texture);
                out.post(format!("Opened {name} as the texture's profile: {read}"));
            }
            Err(error) => out.not_opened(name, &error),
        }
    }
}
