//! Programs handed over, late, twice, or stopped on the way.

use std::boxed::Box;
use std::format;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use slipline_dds::bank::BLOCK;
use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{FinePosition, Gain};

use super::*;
use crate::listening::capture::Values;
use crate::listening::listener::Listener;
use crate::motion::{Motion, Placement};
use crate::planning::program::{Program, Target};
use crate::ports::{CycleCounter, DacStream, HasMuted, Mute, RendererPorts, Underrun};
use crate::renderer::Renderer;
use crate::slots::{SlotIndex, TableRef};

/// Blocks between two changes of the thermal limit at 400 kS/s: 320 ms.
const LIMIT_BLOCKS: u64 = 1000;

type Local = Mailbox<NoopRawMutex>;

fn mailbox() -> Box<Local> {
    let mailbox = Box::new(Local::new());
    for index in 0..2u16 {
        let step = 40_000_000 + u32::from(index) * 1_000_000;
        mailbox.write_knot(SlotIndex::Second, index, Knot { step, gain: Gain::FULL });
    }
    mailbox
}

#[test]
fn a_mailbox_set_up_in_used_memory_equals_a_new_one() {
    let (used, _) = sounding();
    let mut place = Box::new(MaybeUninit::new(*used));
    let (set_up, new) = (Local::new_in(&mut place), Local::new());
    assert_eq!(format!("{:?}", set_up.view()), format!("{:?}", new.view()));
    assert_eq!(set_up.slots().knot(SlotIndex::Second, 1), Knot::default());
    assert_eq!((set_up.pulses(), set_up.digest()), (new.pulses(), new.digest()));
    assert_eq!(set_up.slot_is_free(SlotIndex::First), new.slot_is_free(SlotIndex::First));
}

/// A tone that starts from silence at full scale.
fn onset(at: SampleIndex, mailbox: &Local) -> Motion {
    let mut targets = [None; MAX_TONES];
    targets[2] = Some(Target { position: FinePosition::END, level: Gain::FULL, phase: 0, setting: None });
    let table = TableRef { slot: SlotIndex::Second, knots: 2 };
    let program = Program { at, glide: 2000, table, targets };
    Motion::silent().follow(&[Placement::default(); MAX_TONES], &program, mailbox.slots())
}

/// Renders blocks, fed, and returns the last.
fn render(renderer: &mut Renderer, mailbox: &Local, blocks: u32) -> [u16; BLOCK] {
    let mut codes = [0; BLOCK];
    for _ in 0..blocks {
        mailbox.feed();
        renderer.render(mailbox, &mut codes);
    }
    codes
}

fn sounding() -> (Box<Local>, Renderer) {
    let (mailbox, mut renderer) = (mailbox(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &mailbox, 1);
    let at = mailbox.arm();
    assert_eq!(mailbox.publish(&onset(at, &mailbox), &mailbox.view()), Ok(()));
    render(&mut renderer, &mailbox, 40);
    assert!(!mailbox.view().is_silent());
    (mailbox, renderer)
}

#[test]
fn a_program_is_refused_while_another_is_pending_and_when_its_index_has_passed() {
    let (mailbox, mut renderer) = (mailbox(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &mailbox, 2);
    let view = mailbox.view();
    assert_eq!(mailbox.publish(&onset(view.next + 256, &mailbox), &view), Ok(()));
    assert_eq!(mailbox.publish(&onset(view.next + 512, &mailbox), &view), Err(NotPublished::Pending));
    mailbox.stop(Stop::Normal);
    render(&mut renderer, &mailbox, 1);
    assert_eq!(mailbox.publish(&onset(view.next, &mailbox), &view), Err(NotPublished::Late));
    assert_eq!(mailbox.publish(&onset(mailbox.now(), &mailbox), &view), Ok(()));
}

#[test]
fn a_program_made_for_a_motion_that_has_changed_since_is_refused() {
    let (mailbox, mut renderer) = sounding();
    let view = mailbox.view();
    mailbox.stop(Stop::Normal);
    assert_eq!(
        mailbox.publish(&onset(view.next, &mailbox), &view),
        Err(NotPublished::Late),
        "the stop is ordered"
    );
    render(&mut renderer, &mailbox, 1);
    assert_eq!(
        mailbox.publish(&onset(mailbox.now(), &mailbox), &view),
        Err(NotPublished::Late),
        "the stop ramps"
    );
    assert!(mailbox.view().stopping);
}

#[test]
fn a_slot_that_sounds_is_not_written() {
    let (mailbox, mut renderer) = sounding();
    let before = mailbox.slots().knot(SlotIndex::Second, 0);
    mailbox.write_knot(SlotIndex::Second, 0, Knot::default());
    assert_eq!(mailbox.slots().knot(SlotIndex::Second, 0), before);
    assert!(mailbox.slot_is_free(SlotIndex::First));
    mailbox.stop(Stop::Emergency);
    render(&mut renderer, &mailbox, 20);
    assert!(mailbox.slot_is_free(SlotIndex::Second), "silence frees it");
}

#[test]
fn a_slot_that_a_pending_program_goes_by_is_not_written() {
    let (mailbox, mut renderer) = (mailbox(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &mailbox, 1);
    assert!(mailbox.slot_is_free(SlotIndex::Second));
    assert_eq!(mailbox.publish(&onset(mailbox.now() + 4096, &mailbox), &mailbox.view()), Ok(()));
    assert!(!mailbox.slot_is_free(SlotIndex::Second));
    assert!(mailbox.slot_is_free(SlotIndex::First));
}

#[test]
fn the_thermal_limit_is_approached_slowly_and_kept() {
    let (mailbox, mut renderer) = sounding();
    mailbox.set_limit(1000);
    render(&mut renderer, &mailbox, 1);
    let mut last = mailbox.view().report.sum;
    assert_eq!(last, u64::from(Gain::FULL.0));
    // It changes at every 1000th block only.
    mailbox.set_limit(250);
    render(&mut renderer, &mailbox, (LIMIT_BLOCKS - mailbox.now() / BLOCK as u64) as u32);
    assert_eq!(mailbox.view().report.sum, last);
    assert_eq!(Timing::at(400_000).limit_since(mailbox.now()), 0);
    for _ in 0..80 {
        render(&mut renderer, &mailbox, 1);
        let sum = mailbox.view().report.sum;
        assert!(last - sum <= u64::from(Gain::FULL.0) / 64, "{last} {sum}");
        last = sum;
    }
    assert_eq!(last, u64::from(Gain::FULL.0) / 4);
    assert_eq!(Timing::at(400_000).limit_since(mailbox.now()), LIMIT_BLOCKS * BLOCK as u64);
    mailbox.set_limit(1000);
    render(&mut renderer, &mailbox, LIMIT_BLOCKS as u32);
    assert_eq!(mailbox.view().report.sum, u64::from(Gain::FULL.0));
}

#[test]
fn the_first_thermal_limit_is_in_force_before_anything_can_sound() {
    let (mailbox, mut renderer) = (mailbox(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &mailbox, 3);
    mailbox.set_limit(500);
    let at = mailbox.arm();
    assert_eq!(mailbox.publish(&onset(at, &mailbox), &mailbox.view()), Ok(()));
    for _ in 0..40 {
        render(&mut renderer, &mailbox, 1);
        assert!(mailbox.view().report.sum <= u64::from(Gain::FULL.0) / 2);
    }
    assert_eq!(mailbox.view().report.sum, u64::from(Gain::FULL.0) / 2);
}

/// Revises the last block for a stop at once; whether it began there.
fn revise(renderer: &mut Renderer, mailbox: &Local, codes: &mut [u16; BLOCK]) -> bool {
    renderer.revise(mailbox, codes, |_| Ok::<_, Underrun>(())) == Ok(true)
}

#[test]
fn a_block_with_a_stop_in_it_is_reported_as_it_is_played() {
    let (mailbox, mut renderer) = sounding();
    let before = mailbox.view().report;
    let mut codes = render(&mut renderer, &mailbox, 1);
    let last = mailbox.now() - BLOCK as u64;
    mailbox.fault_at_once(Fault::EmergencyStop, Stop::Emergency);
    assert!(revise(&mut renderer, &mailbox, &mut codes));
    assert_eq!(mailbox.stopped_at(), last + 1);
    let view = mailbox.view();
    assert!(view.stopping && !view.armed && view.faults.set().contains(Fault::EmergencyStop));
    let squares = codes.map(|code| u64::from(code.abs_diff(slipline_dds::bank::code::MID_SCALE)).pow(2));
    assert_eq!(view.report.energy, before.energy + squares.iter().sum::<u64>());
    // A raised cosine after 128 of 800 samples.
    let left = (1.0 + (core::f64::consts::PI * 128.0 / 800.0).cos()) / 2.0;
    let sum = view.report.sum as f64 / f64::from(Gain::FULL.0);
    assert!((sum - left).abs() < 1e-4, "{sum} of {left}");
    render(&mut renderer, &mailbox, 6);
    assert!(mailbox.view().is_silent(), "its 800 samples count from that block on");
}

#[test]
fn a_stop_at_once_begins_with_the_next_block() {
    let (mailbox, mut renderer) = sounding();
    let mut codes = render(&mut renderer, &mailbox, 1);
    mailbox.stop_at_once(Stop::Normal);
    assert_eq!(mailbox.stopped_at(), mailbox.now());
    assert!(!revise(&mut renderer, &mailbox, &mut codes), "the answered index must stay");
    assert!(mailbox.view().stopping && !mailbox.view().report.stopping);
    let sum = mailbox.view().report.sum;
    render(&mut renderer, &mailbox, 1);
    assert!(mailbox.view().report.sum < sum);
}

#[test]
fn a_stop_that_is_not_at_once_never_begins_in_a_block_that_was_rendered() {
    let (mailbox, mut renderer) = sounding();
    let mut codes = render(&mut renderer, &mailbox, 1);
    // The renderer has taken this one with its next block, before it looked.
    mailbox.stop_at_once(Stop::Normal);
    render(&mut renderer, &mailbox, 1);
    mailbox.disarm(Stop::Emergency);
    assert!(!revise(&mut renderer, &mailbox, &mut codes));
}

#[test]
fn a_ramp_under_way_that_ends_sooner_is_not_restarted() {
    let (mailbox, mut renderer) = sounding();
    mailbox.stop(Stop::Emergency);
    let mut codes = render(&mut renderer, &mailbox, 2);
    let (played, sum) = (codes, mailbox.view().report.sum);
    mailbox.stop_at_once(Stop::Normal);
    assert!(!revise(&mut renderer, &mailbox, &mut codes));
    assert_eq!((mailbox.stopped_at(), codes, mailbox.view().report.sum), (mailbox.now(), played, sum));
    mailbox.stop_at_once(Stop::Emergency);
    assert!(!revise(&mut renderer, &mailbox, &mut codes));
    render(&mut renderer, &mailbox, 5);
    assert!(mailbox.view().is_silent());
}

/// The counter's readings, before and after each block.
struct Readings(std::vec::IntoIter<u32>);

impl CycleCounter for Readings {
    fn cycles(&mut self) -> u32 {
        self.0.next().unwrap()
    }
}

/// A DAC with room for a number of blocks.
struct Takes(u32);

impl DacStream for Takes {
    async fn room(&mut self) {
        if self.0 == 0 {
            core::future::pending::<()>().await;
        }
        self.0 -= 1;
    }

    async fn write_block(&mut self, _: &[u16; BLOCK]) -> Result<(), Underrun> {
        Ok(())
    }

    fn is_revisable(&self) -> bool {
        false
    }

    fn revise_block(&mut self, _: &[u16; BLOCK]) -> Result<(), Underrun> {
        Err(Underrun)
    }
}

struct NoPin;

impl Mute for NoPin {
    fn set_muted(&mut self, _: bool) {}

    fn stay_on(&mut self) -> Result<(), HasMuted> {
        Ok(())
    }
}

#[test]
fn the_reported_cost_is_that_of_the_most_expensive_block() {
    // the last block's cost says nothing about the deadline. The counter wraps amid the second. A block costs its
    // rendering, and then its listening.
    let (mailbox, mut renderer) = (mailbox(), Renderer::new(Timing::at(400_000)));
    let start = u32::MAX - 450;
    let costs = [100, 900, 300, 5];
    let readings: std::vec::Vec<u32> = costs
        .iter()
        .scan(start, |now, cost| {
            let (rendered, listened) = (cost - cost / 3, cost / 3);
            let before = *now;
            let between = before.wrapping_add(rendered);
            // The wait for the DAC does not count as cost.
            let after = between.wrapping_add(10_000);
            *now = after.wrapping_add(listened);
            Some([before, between, after, *now])
        })
        .flatten()
        .collect();
    let counter = Readings(readings.into_iter());
    let ports =
        RendererPorts { dac: Takes(4), mute: NoPin, trigger: (), button: (), cycles: counter, sense: () };
    let values = Values::new();
    let mut listener = Listener::starting_at(renderer.index(), &values);
    let mut running = core::pin::pin!(renderer.run(&mailbox, ports, &mut listener));
    let mut context = core::task::Context::from_waker(core::task::Waker::noop());
    assert!(running.as_mut().poll(&mut context).is_pending());
    assert_eq!(mailbox.view().report.max_cycles, 900);
}

#[test]
fn a_renderer_that_is_not_armed_plays_no_pending_program() {
    let (mailbox, mut renderer) = (mailbox(), Renderer::new(Timing::at(400_000)));
    render(&mut renderer, &mailbox, 2);
    assert_eq!(mailbox.publish(&onset(mailbox.now(), &mailbox), &mailbox.view()), Ok(()));
    assert_eq!(render(&mut renderer, &mailbox, 40), [slipline_dds::bank::code::MID_SCALE; BLOCK]);
    assert!(renderer.is_muted());
}

/// A lock between true threads.
#[cfg(not(target_family = "wasm"))]
struct BetweenThreads(std::sync::Mutex<()>);

#[cfg(not(target_family = "wasm"))]
#[expect(unsafe_code, reason = "the trait is unsafe; listed in firmware/UNSAFE.md")]
// SAFETY: the standard library's mutex lets one thread in at a time; no lock is taken within another.
unsafe impl RawMutex for BetweenThreads {
    const INIT: Self = Self(std::sync::Mutex::new(()));

    fn lock<R>(&self, f: impl FnOnce() -> R) -> R {
        let _held = self.0.lock().unwrap();
        f()
    }
}

// It needs a second thread, which wasm32-wasip1 lacks.
#[cfg(not(target_family = "wasm"))]
#[test]
fn a_view_never_mixes_two_motions() {
    use std::sync::atomic::{AtomicBool, Ordering};

    const ROUNDS: u64 = 20_000;
    let mailbox = Box::new(Mailbox::<BetweenThreads>::new());
    let is_over = AtomicBool::new(false);
    // Every tone of one motion has the same level, so a mixture shows.
    let levels = |round: u64| {
        let here = Placement { level: Gain(round as u32 + 1), ..Placement::NOWHERE };
        [here; MAX_TONES]
    };
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for round in 0..ROUNDS {
                mailbox.fade(&levels(round), round * BLOCK_SAMPLES, 1000);
            }
            is_over.store(true, Ordering::Relaxed);
        });
        let mut last = 0;
        while !is_over.load(Ordering::Relaxed) {
            let motion = mailbox.view().motion;
            let here = motion.at(motion.start(), mailbox.slots());
            assert!(here.iter().all(|placement| placement.level == here[0].level), "{here:?}");
            let round = u64::from(here[0].level.0.saturating_sub(1));
            assert!(
                motion.start() == round * BLOCK_SAMPLES && round >= last,
                "the outline is the same motion's"
            );
            last = round;
        }
    });
}
