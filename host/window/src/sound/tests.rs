//! The speaker without a sound card.

use super::mix::{IDLE, Mix, PATIENCE};
use super::system::SampleSource;
use super::{Speaker as _, SpeakerState, SystemSpeaker};
use slipline_model::sound::{Partial, Sound, Synth};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

fn tone() -> Sound {
    Sound { partials: vec![Partial { slot: 0, frequency_hz: 440.0, amplitude: 0.5 }], noise: 0.0 }
}

fn loudest(mix: &Mix, synth: &mut Synth, now: Instant) -> f32 {
    let mut samples = [0.0; 9600];
    mix.fill(synth, &mut samples, now);
    samples[4800..].iter().fold(0.0, |most, sample| sample.abs().max(most))
}

#[test]
fn a_sound_ends_when_the_app_sends_no_more_updates() {
    let begin = Instant::now();
    let (mix, mut synth) = (Mix::new(begin), Synth::new(48e3));
    assert_eq!(loudest(&mix, &mut synth, begin), 0.0);
    mix.set(tone(), 0.5, begin);
    let moment = Duration::from_millis(1);
    assert!((loudest(&mix, &mut synth, begin + PATIENCE - moment) - 0.25).abs() < 0.01);
    assert!(loudest(&mix, &mut synth, begin + PATIENCE) < 1e-4, "a window that hangs");
    mix.set(tone(), 0.5, begin + 2 * PATIENCE);
    assert!(loudest(&mix, &mut synth, begin + 2 * PATIENCE) > 0.2, "it is back");
}

#[test]
fn the_card_is_let_go_after_a_long_silence_only() {
    let begin = Instant::now();
    let mix = Mix::new(begin);
    mix.set(tone(), 0.5, begin + IDLE);
    mix.set(Sound::default(), 0.5, begin + IDLE + PATIENCE);
    assert!(!mix.is_idle(begin + 2 * IDLE - Duration::from_millis(1)));
    assert!(mix.is_idle(begin + 2 * IDLE));
}

/// Waits until the speaker is in this state.
fn wait_for(speaker: &SystemSpeaker, wanted: &SpeakerState) {
    let until = Instant::now() + Duration::from_secs(20);
    while speaker.state() != *wanted {
        assert!(Instant::now() < until, "still {:?}", speaker.state());
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn the_card_is_opened_by_the_first_sound_and_a_failure_is_reported_and_tried_again_when_asked() {
    let (give, answers) = channel::<anyhow::Result<()>>();
    let (woken, wakes) = channel();
    let card = move |playing: &dyn Fn(), mut source: SampleSource| {
        playing();
        let mut samples = [0.0; 48];
        assert!(source.fill(48e3, &mut samples), "it has just sounded");
        answers.recv().unwrap_or(Ok(()))
    };
    let wake = move || {
        // The test may have ended.
        let _ = woken.send(());
    };
    let speaker = SystemSpeaker::with(wake, card).unwrap();
    speaker.play(Sound::default(), 0.5);
    assert_eq!(speaker.state(), SpeakerState::Closed, "nothing is heard, so no card is opened");
    speaker.play(tone(), 0.5);
    wait_for(&speaker, &SpeakerState::Playing);
    assert!(wakes.recv().is_ok(), "the window shows it");
    give.send(Err(anyhow::anyhow!("unplugged"))).unwrap();
    let failed = SpeakerState::Failed("unplugged".to_owned());
    wait_for(&speaker, &failed);
    speaker.play(tone(), 0.5);
    assert_eq!(speaker.state(), failed, "it is not tried at every frame");
    speaker.retry();
    speaker.play(tone(), 0.5);
    wait_for(&speaker, &SpeakerState::Playing);
    give.send(Ok(())).unwrap();
    wait_for(&speaker, &SpeakerState::Closed);
}
