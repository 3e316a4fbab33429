//! Textures: what is made of a draft and a file, and what playing them says and sends.

use crate::session::Session;
use slipline_model::scenes::SCENES;
use slipline_model::texture::{WishDraft, WishKind};

/// The scene of a first start, driven, with this kind of texture on the open page.
fn first_start(kind: WishKind) -> Session {
    let mut session = Session::driving_setup(SCENES[0].setup().unwrap());
    session.move_to(209.0);
    session.pass(600);
    session.attention.is_texture_open = true;
    session.pass(100);
    draft(&mut session, |draft| draft.kind = kind);
    session
}

/// Changes the draft, and waits for its texture.
fn draft(session: &mut Session, change: impl FnOnce(&mut WishDraft)) {
    let mut draft = session.instrument.shown().texture.draft.clone();
    change(&mut draft);
    session.instrument.screen.draft_texture(draft);
    session.pass(600);
}

/// The number of tones of the draft's texture, or why there is none.
fn made(session: &Session) -> Result<usize, String> {
    let texture = session.instrument.shown().texture;
    assert!(texture.is_current);
    let result = texture.latest.unwrap().result.as_ref();
    result.map(|made| made.tones.len()).map_err(ToString::to_string)
}

#[test]
fn a_texture_begins_from_rest_and_is_not_refused_for_the_way_to_it() {
    let mut session = first_start(WishKind::Profile);
    session.instrument.play_texture();
    session.pass(600);
    assert!(session.instrument.desk.setup().tones.len() > 1 && session.is_driving());
    session.instrument.undo();
    session.pass(600);
    assert_eq!(session.instrument.desk.setup().tones.len(), 1);
    assert!(!session.is_logged("add up to"), "the device refused the way first");
}

#[test]
fn bad_profiles_are_refused_by_name_and_change_nothing() {
    let mut session = Session::driving();
    session.attention.is_texture_open = true;
    session.pass(300);
    let profile = |session: &Session| session.instrument.shown().texture.draft.profile.clone();
    let before = profile(&session);
    for (name, bytes, reason) in [
        ("bad.csv", &b"0.1,1\nnonsense,2\n"[..], "Line 2"),
        ("bad.png", b"\x89PNG\r\n\x1a\nnot an image", "PNG"),
    ] {
        session.instrument.take_profile(name, bytes);
        session.turn();
        let notice = session.instrument.out.notices().last().unwrap().clone();
        assert!(notice.is_error && notice.text.contains(name) && notice.text.contains(reason), "{notice:?}");
        assert_eq!(profile(&session), before);
    }
    // The file reader takes breakpoints that are not in order; the texture's job refuses them.
    session.instrument.take_profile("mixed.csv", b"0.2,1\n0.1,1\n");
    session.pass(300);
    assert!(made(&session).is_err_and(|reason| reason.contains("breakpoint 2 of the profile")));
}

#[test]
fn a_beat_is_possible_on_the_first_plate_and_its_range_does_not_run_backwards() {
    let mut session = first_start(WishKind::Beat);
    assert_eq!(made(&session), Ok(2));
    draft(&mut session, |draft| draft.beat_hz = 300.0);
    let refused = made(&session).unwrap_err();
    let range = refused.split("beat frequency = 300 Hz: must be ").nth(1).unwrap();
    let ends: Vec<f64> = range.split(' ').filter_map(|word| word.parse().ok()).collect();
    assert!(ends.len() == 2 && ends[0] < ends[1], "{refused}");
}

#[test]
fn a_texture_that_moves_the_lines_to_turning_points_says_so() {
    let mut session = first_start(WishKind::Stripes);
    session.instrument.play_texture();
    session.pass(300);
    let notice = session.notice();
    assert!(notice.starts_with("The lines are at turning points now"), "{notice}");
}
