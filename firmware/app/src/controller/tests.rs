//! What no message can bring about: a fold-back that does not hold the coil, a memory that flips.

use std::boxed::Box;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use slipline_protocol::command::{Apply, Drive, TableChunk, Tone};
use slipline_protocol::event::Faults;
use slipline_protocol::table::{self, Knot};
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};

use super::*;
use crate::bank::BLOCK;
use crate::ports::NoFlash;
use crate::renderer::Renderer;
use crate::timing::TICK_BLOCKS;

/// Few samples, so that minutes are few blocks.
const RATE: u32 = 8000;
const KNOTS: [Knot; 2] =
    [Knot { step: 200_000_000, gain: Gain::FULL }, Knot { step: 100_000_000, gain: Gain::FULL }];

/// A system without a bootloader.
struct Bare;

impl System for Bare {
    fn has_bootloader(&self) -> bool {
        false
    }

    fn enter_bootloader(&mut self) {}
}

/// Both halves of the application, without a link between them and the test.
struct Bench {
    controller: Controller<NoFlash, Bare>,
    crossing: Box<Crossing<NoopRawMutex>>,
    renderer: Renderer,
}

impl Bench {
    /// A device with a table, armed.
    fn armed() -> Self {
        let device = Device {
            board: "bench",
            build: "",
            firmware: (0, 0, 0),
            unit: [0; 12],
            simulated: true,
            sample_rate_hz: RATE,
        };
        let mut bench = Self {
            controller: Controller::new(device, Boot::cold(), NoFlash, Bare),
            crossing: Box::new(Crossing::new()),
            renderer: Renderer::new(Timing::at(RATE)),
        };
        bench.controller.start(&bench.crossing);
        let crc = table::digest(0, 300_000, RATE, 2, |index| KNOTS[usize::from(index)]);
        let header =
            TableHeader { knots: 2, span_start_um: 0, span_end_um: 300_000, sample_rate_hz: RATE, crc };
        bench.accepted(&Command::TableBegin(header));
        bench.accepted(&Command::TableChunk(TableChunk { first: 0, knots: KNOTS.into_iter().collect() }));
        bench.accepted(&Command::TableCommit);
        bench.render(TICK_BLOCKS);
        bench.accepted(&Command::Arm);
        bench
    }

    fn execute(&mut self, command: &Command) -> Result<Event, Refusal> {
        self.controller.execute(command, &self.crossing)
    }

    fn accepted(&mut self, command: &Command) {
        let answer = self.execute(command);
        assert!(matches!(answer, Ok(Event::Accepted(_))), "{command:?}: {answer:?}");
    }

    /// Renders blocks while the host lives.
    fn render(&mut self, blocks: u64) {
        for _ in 0..blocks {
            self.crossing.feed();
            self.renderer.render(&self.crossing, &mut [0; BLOCK]);
        }
    }

    fn faults(&self) -> Faults {
        self.crossing.view().faults.set()
    }

    /// The checksum that the device tells of its table.
    fn told_crc(&mut self) -> Option<u32> {
        match self.execute(&Command::TableDigest) {
            Ok(Event::Table(report)) => report.active.map(|header| header.crc),
            other => panic!("{other:?}"),
        }
    }
}

fn full_scale() -> Command {
    let tone = Tone { slot: 0, position: Position(0), level: Level(u16::MAX), phase: Phase(0) };
    let tones = [tone].into_iter().collect();
    Command::Drive(Drive { tones, master: CentiDecibel(0), glide: 200, apply: Apply::Next })
}

#[test]
fn a_coil_that_the_fold_back_does_not_hold_is_switched_off() {
    //
    let mut bench = Bench::armed();
    bench.accepted(&full_scale());
    let ticks_of_two_minutes = 120 * u64::from(RATE) / (TICK_BLOCKS * BLOCK as u64);
    let hot = (0..ticks_of_two_minutes).find(|_| {
        bench.render(TICK_BLOCKS);
        bench.controller.tick(&bench.crossing);
        let is_hot = bench.faults().contains(Fault::Overheat);
        // As if no amplitude obeyed.
        bench.crossing.set_limit(1000);
        is_hot
    });
    assert!(hot.is_some(), "a full sine is over the limit within two minutes");
    let first = bench.crossing.view().faults.first();
    bench.render(8 * TICK_BLOCKS);
    bench.controller.tick(&bench.crossing);
    assert!(bench.crossing.view().is_silent() && bench.renderer.is_muted());
    assert_eq!(bench.crossing.view().faults.first(), first);
    assert_eq!(bench.execute(&Command::ClearFaults).map(|_| bench.faults()), Ok(bench.faults()));
    assert!(bench.faults().contains(Fault::Overheat), "it is still warm");
}

#[test]
fn the_checksum_told_is_of_what_the_memory_holds() {
    let mut bench = Bench::armed();
    let before = bench.told_crc();
    bench.crossing.write_knot(bench.controller.active.slot, 1, Knot { step: 100_000_001, ..KNOTS[1] });
    assert!(before.is_some());
    assert_ne!(bench.told_crc(), before);
}

#[test]
fn a_new_session_knows_no_digest_of_the_last() {
    let mut bench = Bench::armed();
    let window = DigestWindow { from: bench.crossing.now() + 10_000, count: 1000 };
    bench.accepted(&Command::DigestStart(window));
    assert_eq!(
        bench.execute(&Command::DigestStart(window)),
        Err(Refusal::Busy(Busy::DigestPending)),
        "one at a time"
    );
    bench.controller.begin_session(&bench.crossing);
    assert_eq!(bench.execute(&Command::DigestRead), Err(Refusal::NoDigest));
    bench.accepted(&Command::DigestStart(window));
}
