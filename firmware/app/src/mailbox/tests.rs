//! Programs handed over, late, twice, or stopped on the way.

use std::boxed::Box;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::units::{FinePosition, Gain};

use super::*;
use crate::bank::BLOCK;
use crate::motion::Placement;
use crate::program::{Program, Target};
use crate::renderer::Renderer;
use crate::slots::{SlotIndex, TableRef};
use crate::timing::Timing;

/// Blocks between two changes of the thermal limit at 400 kS/s: 320 ms.
const LIMIT_BLOCKS: u64 = 1000;

type Local = Crossing<NoopRawMutex>;

fn crossing() -> Box<Local> {
    let crossing = Box::new(Local::new());
    for index in 0..2u16 {
        let step = 40_000_000 + u32::from(index) * 1_000_000;
        crossing.write_knot(SlotIndex::Second, index, Knot { step, gain: Gain::FULL });
    }
    crossing
}

/// A tone that starts from silence at full scale.
fn onset(at: SampleIndex, crossing: &Local) -> Motion {
    let mut targets = [None; MAX_TONES];
    targets[2] = Some(Target { position: FinePosition::END, level: Gain::FULL, phase: 0 });
    let table = TableRef { slot: SlotIndex::Second, knots: 2 };
    let program = Program { at, glide: 2000, table, targets };
    Motion::silent().follow(&[Placement::default(); MAX_TONES], &program, crossing.slots())
}

/// Renders blocks, fed, and returns the last.
fn render(renderer: &mut Renderer, crossing: &Local, blocks: u32) -> [u16; BLOCK] {
    let mut codes = [0; BLOCK];
    for _ in 0..blocks {
        crossing.feed();
        renderer.render(crossing, &mut codes);
    }
    codes
}

fn sounding() -> (Box<Local>, Renderer) {
    let (crossing, mut renderer) = (crossing(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &crossing, 1);
    let at = crossing.arm();
    assert_eq!(crossing.publish(onset(at, &crossing), &crossing.view()), Ok(()));
    render(&mut renderer, &crossing, 40);
    assert!(!crossing.view().is_silent());
    (crossing, renderer)
}

#[test]
fn a_program_is_refused_while_another_is_pending_and_when_its_index_has_passed() {
    let (crossing, mut renderer) = (crossing(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &crossing, 2);
    let view = crossing.view();
    assert_eq!(crossing.publish(onset(view.next + 256, &crossing), &view), Ok(()));
    assert_eq!(crossing.publish(onset(view.next + 512, &crossing), &view), Err(NotPublished::Pending));
    crossing.stop(Stop::Normal);
    render(&mut renderer, &crossing, 1);
    assert_eq!(crossing.publish(onset(view.next, &crossing), &view), Err(NotPublished::Late));
    assert_eq!(crossing.publish(onset(crossing.now(), &crossing), &view), Ok(()));
}

#[test]
fn a_program_made_for_a_motion_that_has_changed_since_is_refused() {
    let (crossing, mut renderer) = sounding();
    let view = crossing.view();
    crossing.stop(Stop::Normal);
    assert_eq!(
        crossing.publish(onset(view.next, &crossing), &view),
        Err(NotPublished::Late),
        "the stop is ordered"
    );
    render(&mut renderer, &crossing, 1);
    assert_eq!(
        crossing.publish(onset(crossing.now(), &crossing), &view),
        Err(NotPublished::Late),
        "the stop ramps"
    );
    assert!(crossing.view().stopping);
}

#[test]
fn a_slot_that_sounds_is_not_written() {
    let (crossing, mut renderer) = sounding();
    let before = crossing.slots().knot(SlotIndex::Second, 0);
    crossing.write_knot(SlotIndex::Second, 0, Knot::default());
    assert_eq!(crossing.slots().knot(SlotIndex::Second, 0), before);
    assert!(crossing.slot_is_free(SlotIndex::First));
    crossing.stop(Stop::Emergency);
    render(&mut renderer, &crossing, 20);
    assert!(crossing.slot_is_free(SlotIndex::Second), "silence frees it");
}

#[test]
fn a_slot_that_a_pending_program_goes_by_is_not_written() {
    let (crossing, mut renderer) = (crossing(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &crossing, 1);
    assert!(crossing.slot_is_free(SlotIndex::Second));
    assert_eq!(crossing.publish(onset(crossing.now() + 4096, &crossing), &crossing.view()), Ok(()));
    assert!(!crossing.slot_is_free(SlotIndex::Second));
    assert!(crossing.slot_is_free(SlotIndex::First));
}

#[test]
fn the_thermal_limit_is_approached_slowly_and_kept() {
    let (crossing, mut renderer) = sounding();
    crossing.set_limit(1000);
    render(&mut renderer, &crossing, 1);
    let mut last = crossing.view().report.sum;
    assert_eq!(last, u64::from(Gain::FULL.0));
    // It changes at every 1000th block only.
    crossing.set_limit(250);
    render(&mut renderer, &crossing, (LIMIT_BLOCKS - crossing.now() / BLOCK as u64) as u32);
    assert_eq!(crossing.view().report.sum, last);
    assert_eq!(Timing::at(400_000).limit_since(crossing.now()), 0);
    for _ in 0..80 {
        render(&mut renderer, &crossing, 1);
        let sum = crossing.view().report.sum;
        assert!(last - sum <= u64::from(Gain::FULL.0) / 64, "{last} {sum}");
        last = sum;
    }
    assert_eq!(last, u64::from(Gain::FULL.0) / 4);
    assert_eq!(Timing::at(400_000).limit_since(crossing.now()), LIMIT_BLOCKS * BLOCK as u64);
    crossing.set_limit(1000);
    render(&mut renderer, &crossing, LIMIT_BLOCKS as u32);
    assert_eq!(crossing.view().report.sum, u64::from(Gain::FULL.0));
}

#[test]
fn the_first_thermal_limit_is_in_force_before_anything_can_sound() {
    let (crossing, mut renderer) = (crossing(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &crossing, 3);
    crossing.set_limit(500);
    let at = crossing.arm();
    assert_eq!(crossing.publish(onset(at, &crossing), &crossing.view()), Ok(()));
    for _ in 0..40 {
        render(&mut renderer, &crossing, 1);
        assert!(crossing.view().report.sum <= u64::from(Gain::FULL.0) / 2);
    }
    assert_eq!(crossing.view().report.sum, u64::from(Gain::FULL.0) / 2);
}

#[test]
fn a_renderer_that_is_not_armed_plays_nothing_whatever_is_pending() {
    let (crossing, mut renderer) = (crossing(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &crossing, 2);
    assert_eq!(crossing.publish(onset(crossing.now(), &crossing), &crossing.view()), Ok(()));
    assert_eq!(render(&mut renderer, &crossing, 40), [crate::bank::code::MID_SCALE; BLOCK]);
    assert!(renderer.is_muted());
}
