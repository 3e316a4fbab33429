//! What no message alone can bring about: a fold-back that does not hold the coil, a memory that flips, an interrupt
//! between two steps of a command.

mod holding;
mod interleaving;
mod stops;

use core::cell::{Cell, RefCell};
use std::boxed::Box;
use std::rc::Rc;

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_dds::bank::BLOCK;
use slipline_dds::bank::code::MID_SCALE;
use slipline_protocol::command::{Apply, Drive, TableChunk, Tone};
use slipline_protocol::event::{Counters, Faults, State};
use slipline_protocol::table::{self, Knot};
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};

use super::*;
use crate::ports::{FLASH_WORD, FlashError, FlashSlot, NoFlash};
use crate::renderer::Renderer;
use crate::timing::TICK_BLOCKS;

/// Few samples, so that minutes are few blocks.
const RATE: u32 = 8000;
const KNOTS: [Knot; 2] =
    [Knot { step: 200_000_000, gain: Gain::FULL }, Knot { step: 100_000_000, gain: Gain::FULL }];

impl Device {
    /// A device that is nothing in particular.
    pub(crate) const fn of_a_test(sample_rate_hz: u32) -> Self {
        Self { board: "test", build: "", firmware: (0, 0, 0), unit: [0; 12], simulated: true, sample_rate_hz }
    }
}

const DEVICE: Device = Device::of_a_test(RATE);

/// A system that remembers whether its bootloader was entered.
#[derive(Clone, Default)]
struct Rom(Rc<RefCell<bool>>);

impl System for Rom {
    fn has_bootloader(&self) -> bool {
        true
    }

    fn has_trigger_input(&self) -> bool {
        false
    }

    fn is_brown_out_guarded(&self) -> bool {
        true
    }

    fn enter_bootloader(&mut self) {
        *self.0.borrow_mut() = true;
    }
}

/// Something that happens before a lock is taken, and how many locks come before that one.
type Interrupt = (u32, Box<dyn FnOnce()>);

std::thread_local! {
    static INTERRUPT: RefCell<Option<Interrupt>> = const { RefCell::new(None) };
}

/// A mutex before which an interrupt may come.
struct Interrupted;

#[expect(unsafe_code, reason = "the trait is unsafe; listed in firmware/UNSAFE.md")]
// SAFETY: a mailbox behind it is used by one thread only, and an interrupt is over before a lock is taken.
unsafe impl RawMutex for Interrupted {
    const INIT: Self = Self;

    fn lock<R>(&self, f: impl FnOnce() -> R) -> R {
        let due = INTERRUPT.with_borrow_mut(|interrupt| match interrupt.take() {
            Some((0, happens)) => Some(happens),
            later => {
                *interrupt = later.map(|(locks, happens)| (locks - 1, happens));
                None
            }
        });
        if let Some(happens) = due {
            happens();
        }
        f()
    }
}

/// Both halves of the application, without a link between them and the test.
struct Rig {
    controller: Controller<'static, NoFlash, Rom>,
    mailbox: Rc<Mailbox<Interrupted>>,
    renderer: Rc<RefCell<Renderer>>,
    rom: Rom,
}

impl Rig {
    /// A device with a table, armed.
    fn armed() -> Self {
        let rom = Rom::default();
        let mut rig = Self {
            controller: Controller::new(
                DEVICE,
                Boot::cold(),
                NoFlash,
                rom.clone(),
                Box::leak(Box::new(Candidate::new())),
                Box::leak(Box::new(Values::new())),
            ),
            mailbox: Rc::new(Mailbox::new()),
            renderer: Rc::new(RefCell::new(Renderer::new(Timing::at(RATE)))),
            rom,
        };
        rig.controller.start(&rig.mailbox);
        rig.upload();
        rig.render(TICK_BLOCKS);
        rig.accepted(&Command::Arm);
        rig
    }

    /// Uploads the table and commits it.
    fn upload(&mut self) {
        self.stage();
        self.accepted(&Command::TableCommit);
    }

    /// Uploads the table.
    fn stage(&mut self) {
        let crc = table::digest(0, 300_000, RATE, 2, |index| KNOTS[usize::from(index)]);
        let header =
            TableHeader { knots: 2, span_start_um: 0, span_end_um: 300_000, sample_rate_hz: RATE, crc };
        self.accepted(&Command::TableBegin(header));
        self.accepted(&Command::TableChunk(TableChunk { first: 0, knots: KNOTS.into_iter().collect() }));
    }

    fn execute(&mut self, command: &Command) -> Result<Event, Refusal> {
        self.controller.execute(command, &mut || false, &self.mailbox)
    }

    fn accepted(&mut self, command: &Command) {
        let answer = self.execute(command);
        let at = answer.as_ref().ok().and_then(Event::accepted_at);
        assert!(at.is_some(), "{command:?}: {answer:?}");
    }

    /// Renders blocks while the host lives; whether anything sounded.
    fn render(&mut self, blocks: u64) -> bool {
        let mut sounded = false;
        for _ in 0..blocks {
            self.mailbox.feed();
            sounded |= render(&self.renderer, &self.mailbox);
        }
        sounded
    }

    fn faults(&self) -> Faults {
        self.mailbox.view().faults.set()
    }

    /// The checksum of its table that the device reports.
    fn reported_crc(&mut self) -> Option<u32> {
        match self.execute(&Command::TableDigest) {
            Ok(Event::Table(report)) => report.active.map(|header| header.crc),
            other => panic!("{other:?}"),
        }
    }
}

/// Renders a block without a word from the host; whether it sounds.
fn render(renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>) -> bool {
    let mut codes = [0; BLOCK];
    renderer.borrow_mut().render(mailbox, &mut codes);
    codes.iter().any(|&code| code != MID_SCALE)
}

/// A check for a stop that counts its calls in `looks`; from the call after `look` on it orders a stop and returns true.
fn stop_after<'a>(
    look: u32,
    looks: &'a Cell<u32>,
    stop: Stop,
    mailbox: &'a Mailbox<Interrupted>,
) -> impl FnMut() -> bool + 'a {
    move || {
        looks.set(looks.get() + 1);
        let is_due = looks.get() > look;
        if is_due {
            mailbox.stop(stop);
        }
        is_due
    }
}

fn full_scale(apply: Apply) -> Command {
    let tone = Tone { slot: 0, position: Position(0), level: Level(u16::MAX), phase: Phase(0) };
    let tones = [tone].into_iter().collect();
    Command::Drive(Drive { tones, master: CentiDecibel(0), glide: 200, apply })
}

#[test]
fn a_coil_that_the_fold_back_does_not_hold_is_switched_off() {
    //
    let mut rig = Rig::armed();
    rig.accepted(&full_scale(Apply::Next));
    let ticks_of_two_minutes = 120 * u64::from(RATE) / (TICK_BLOCKS * BLOCK as u64);
    let hot = (0..ticks_of_two_minutes).find(|_| {
        rig.render(TICK_BLOCKS);
        rig.controller.tick(&mut || false, &rig.mailbox);
        let is_hot = rig.faults().contains(Fault::Overheat);
        // As if no amplitude obeyed.
        rig.mailbox.set_limit(1000);
        is_hot
    });
    assert!(hot.is_some(), "a full sine is over the limit within two minutes");
    let first = rig.mailbox.view().faults.first();
    rig.render(8 * TICK_BLOCKS);
    rig.controller.tick(&mut || false, &rig.mailbox);
    assert!(rig.mailbox.view().is_silent() && rig.renderer.borrow().is_muted());
    assert_eq!(rig.mailbox.view().faults.first(), first);
    assert_eq!(rig.execute(&Command::ClearFaults).map(|_| rig.faults()), Ok(rig.faults()));
    assert!(rig.faults().contains(Fault::Overheat), "it is still warm");
    rig.render(1000 * TICK_BLOCKS);
    rig.controller.tick(&mut || false, &rig.mailbox);
    rig.accepted(&Command::ClearFaults);
    assert_eq!(rig.faults(), Faults::NONE, "it has cooled");
}

#[test]
fn the_reported_checksum_matches_the_memory() {
    let mut rig = Rig::armed();
    let before = rig.reported_crc();
    rig.mailbox.write_knot(rig.controller.active.slot, 1, Knot { step: 100_000_001, ..KNOTS[1] });
    assert!(before.is_some());
    assert_ne!(rig.reported_crc(), before);
}

#[test]
fn a_new_session_knows_no_digest_of_the_last() {
    let mut rig = Rig::armed();
    let window = DigestWindow { from: rig.mailbox.now() + 10_000, count: 1000 };
    rig.accepted(&Command::DigestStart(window));
    assert_eq!(
        rig.execute(&Command::DigestStart(window)),
        Err(Refusal::Busy(Busy::DigestPending)),
        "one at a time"
    );
    rig.controller.begin_session(&rig.mailbox);
    assert_eq!(rig.execute(&Command::DigestRead), Err(Refusal::NoDigest));
    rig.accepted(&Command::DigestStart(window));
}

#[test]
fn arming_after_the_token_was_shown_keeps_the_device_out_of_its_bootloader() {
    // by the same session or by one that took over.
    for takes_over in [false, true] {
        let mut rig = Rig::armed();
        rig.accepted(&Command::Disarm);
        rig.render(8);
        let Ok(Event::BootloaderToken(token)) = rig.execute(&Command::BootloaderToken) else { panic!() };
        rig.accepted(&Command::BootloaderEnter(token));
        if takes_over {
            rig.controller.begin_session(&rig.mailbox);
        }
        rig.render(1);
        rig.accepted(&Command::Arm);
        for _ in 0..100 {
            rig.render(TICK_BLOCKS);
            rig.controller.tick(&mut || false, &rig.mailbox);
        }
        assert!(!*rig.rom.0.borrow());
        assert!(rig.mailbox.view().armed);
    }
}

#[test]
fn a_takeover_keeps_the_application_running() {
    let mut rig = Rig::armed();
    rig.accepted(&Command::Disarm);
    rig.render(8);
    let Ok(Event::BootloaderToken(token)) = rig.execute(&Command::BootloaderToken) else { panic!() };
    rig.accepted(&Command::BootloaderEnter(token));
    rig.controller.begin_session(&rig.mailbox);
    for _ in 0..100 {
        rig.render(TICK_BLOCKS);
        rig.controller.tick(&mut || false, &rig.mailbox);
    }
    assert!(!*rig.rom.0.borrow());
}

#[test]
fn a_table_swap_after_a_long_armed_silence_is_no_drive() {
    //
    let mut rig = Rig::armed();
    let blocks = rig.controller.timing().max_drive / BLOCK as u64 + 2 * TICK_BLOCKS;
    rig.render(blocks);
    rig.upload();
    rig.controller.tick(&mut || false, &rig.mailbox);
    assert_eq!(rig.faults(), Faults::NONE);
}

/// A flash on which a program ends.
struct Deadly;

impl FlashPages for Deadly {
    fn slot_len(&self, _: FlashSlot) -> usize {
        crate::store::SLOT_BYTES
    }

    fn endurance(&self) -> u32 {
        10_000
    }

    fn erase(&mut self, _: FlashSlot) -> Result<(), FlashError> {
        panic!("erased")
    }

    fn write(&mut self, _: FlashSlot, _: usize, _: &[u8; FLASH_WORD]) -> Result<(), FlashError> {
        panic!("written")
    }

    fn read(&mut self, _: FlashSlot, _: usize, _: &mut [u8; FLASH_WORD]) -> Result<(), FlashError> {
        panic!("read")
    }
}

#[test]
fn safe_mode_does_not_touch_the_kept_table() {
    // the last runs may have ended on it.
    let boot = Boot { safe_mode: true, ..Boot::cold() };
    let mailbox = Mailbox::<Interrupted>::new();
    let mut candidate = Candidate::new();
    let captured = crate::listening::capture::Values::new();
    let mut controller = Controller::new(DEVICE, boot, Deadly, Rom::default(), &mut candidate, &captured);
    controller.start(&mailbox);
    assert_eq!(controller.execute(&Command::Arm, &mut || false, &mailbox), Err(Refusal::SafeMode));
    let answer = controller.execute(&Command::Maintenance, &mut || false, &mailbox);
    let Ok(Event::Maintenance(wear)) = answer else { panic!("{answer:?}") };
    assert_eq!((wear.erasures, wear.erasures_promised), (0, 20_000));
}

#[test]
fn a_new_table_in_silence_is_neither_a_drive_nor_a_stop() {
    let mut rig = Rig::armed();
    let state = |rig: &Rig| rig.controller.status(&rig.mailbox, Counters::default()).state;
    // The swap is pending: nothing has been rendered since.
    rig.upload();
    assert_eq!(state(&rig), State::Armed);
    rig.render(TICK_BLOCKS);
    rig.accepted(&Command::Disarm);
    rig.render(TICK_BLOCKS);
    rig.upload();
    assert_eq!(state(&rig), State::Idle);
    rig.render(TICK_BLOCKS);
    rig.accepted(&Command::Arm);
    rig.accepted(&full_scale(Apply::Next));
    assert_eq!(state(&rig), State::Driving, "a tone is about to sound");
}
