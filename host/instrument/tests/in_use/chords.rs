//! Setups whose tones are a chord, whose peak the device proves.

use crate::fixed_link::{FixedLink, real_device};
use crate::session::Session;
use slipline_instrument::bench::Bench;
use slipline_instrument::{Attention, Instrument, Jobs};
use slipline_link::protocol::event::State;
use slipline_link::protocol::version::MINOR;
use slipline_link::{Change, Played, Request, Sounding};
use slipline_model::field::steady_field::SteadyTone;
use slipline_model::setup::Setup;
use slipline_model::sounding;
use slipline_model::texture::{Wish, make};
use slipline_plate::feeling::Feeling;
use slipline_plate::texture::Palette;
use slipline_plate::{DriveTable, Progress};
use std::sync::Arc;

/// A profile that falls along an aluminium plate, as a chord; and the plate's table.
fn falling() -> (Setup, DriveTable) {
    let plate = slipline_plate::preset("al-bending-displacement").unwrap();
    // The instrument builds its tables with as many knots.
    let table = DriveTable::build(&plate, 400e3, slipline_model::jobs::table::KNOTS).unwrap();
    let wish = Wish::Profile(vec![(0.01, 1.0), (0.17, 0.8), (0.2, 0.2), (0.34, 0.0)]);
    let made = {
        let (palette, mut tell) = (Palette::new(&plate, &table), |_| true);
        let progress = &mut Progress::new(&mut tell);
        make(&palette, &wish, 16, &Feeling::default(), progress)
            .unwrap()
            .finished(&palette, &Feeling::default(), progress)
            .unwrap()
    };
    (made.setup(Arc::new(plate)), table)
}

/// Whether the latest thing that sounds is a chord; `None` if nothing does.
fn sounds_as_chord(session: &Session) -> Option<bool> {
    let snapshot = session.instrument.drive.snapshot();
    sounding::sounding(snapshot)?;
    let is_chord = |change: &Change| match change {
        Change::Play(Played::Chord(_)) => Some(true),
        Change::Play(Played::Drive(_)) => Some(false),
        _ => None,
    };
    snapshot.record.journal.iter().rev().find_map(|entry| is_chord(&entry.change))
}

/// What was asked of the device's tones since the last call.
fn played(session: &Session) -> Vec<Request> {
    let is_of_tones = |request: &Request| {
        matches!(
            request,
            Request::Stop | Request::Play(Sounding::Chord(_)) | Request::Play(Sounding::Drive(_))
        )
    };
    session.take_requests().into_iter().filter(is_of_tones).collect()
}

#[test]
fn a_chord_is_played_as_one_as_loud_as_it_is_drawn_until_a_tone_is_moved() {
    let (setup, table) = falling();
    assert!(setup.chord_gain_db.is_some_and(|gain_db| gain_db > 0.5), "{:?}", setup.chord_gain_db);
    let mut session = Session::driving_setup(setup.clone());
    assert!(session.instrument.desk.setup() == &setup);
    assert_eq!(sounds_as_chord(&session), Some(true));
    let sounding = sounding::sounding(session.instrument.drive.snapshot()).unwrap();
    assert_eq!(sounding.tones.len(), setup.tones.len());
    for tone in &setup.tones {
        let drawn = SteadyTone::of(&setup, tone, &table);
        let at = |other: &&SteadyTone| (other.frequency_hz - drawn.frequency_hz).abs() < 3.0;
        let sounds = sounding.tones.iter().find(at).unwrap();
        assert!((sounds.peak_m / drawn.peak_m - 1.0).abs() < 0.01, "{sounds:?} {drawn:?}");
    }
    // A tone that moves is no multiple any more.
    session.take_requests();
    session.move_to(session.line_mm() - 1.0);
    session.pass(400);
    assert_eq!(session.instrument.desk.setup().chord_gain_db, None);
    assert_eq!(sounds_as_chord(&session), Some(false));
    assert!(session.is_driving() && session.instrument.out.notices().next().is_none());
    assert!(matches!(played(&session)[..], [Request::Stop, Request::Play(Sounding::Drive(_))]));
    // After undo the earlier tones sound as before.
    session.instrument.undo();
    session.pass(400);
    assert_eq!(sounds_as_chord(&session), Some(true));
    assert!(session.is_driving());
    assert!(matches!(played(&session)[..], [Request::Stop, Request::Play(Sounding::Chord(_))]));
}

/// A real device of this minor version of the protocol.
fn of_minor(minor: u8) -> FixedLink {
    let mut link = real_device(State::Idle);
    let snapshot = Arc::make_mut(&mut link.snapshot);
    Arc::make_mut(snapshot.device.identity.as_mut().unwrap()).version.minor = minor;
    link
}

#[test]
fn a_texture_for_a_device_that_plays_no_chords_says_how_much_quieter_it_is() {
    for (minor, is_told) in [(0, true), (MINOR, false)] {
        let link = of_minor(minor);
        assert_eq!(link.snapshot.can_play_chords(), !is_told);
        let plate = slipline_plate::preset("al-bending-displacement").unwrap();
        let mut instrument =
            Instrument::new(Box::new(link), Jobs::inline(), Bench::default(), Setup::new(plate.into()));
        instrument.attend(Attention { is_texture_open: true, ..Attention::default() });
        instrument.take_profile("falling.csv", b"0.01,1\n0.17,0.8\n0.2,0.2\n0.34,0\n");
        for _ in 0..20 {
            instrument.take_reports();
            instrument.turn();
        }
        instrument.play_texture();
        let told = instrument.out.notices().last().unwrap().text.clone();
        assert_eq!(
            told.starts_with("This device plays no chords: the texture is "),
            is_told,
            "{minor}: {told}"
        );
        assert!(instrument.desk.setup().tones.len() > 1);
    }
}
