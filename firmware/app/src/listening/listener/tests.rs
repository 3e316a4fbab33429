//! The listener on a stream that loses blocks, and on a wire from the DAC.
extern crate std;

use super::*;
use crate::listening::capture::{Progress, Recipe};
use crate::mailbox::Mailbox;
use crate::motion::{Motion, Placement};
use crate::planning::program::{Program, Target};
use crate::ports::{DacStream, HasMuted, Mute, RendererPorts, Underrun};
use crate::renderer::Renderer;
use crate::slots::{SlotIndex, TableRef};
use core::cell::{Cell, RefCell};
use core::future::Future as _;
use core::ops::Range;
use core::task::Poll;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use slipline_dds::bank::code::MID_SCALE;
use slipline_dds::lock_in::{BASIS_ONE, Shape, Window};
use slipline_protocol::table::Knot;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{FinePosition, Gain};
use std::collections::VecDeque;
use std::rc::Rc;

/// Blocks of one input, each of one code, and the losses between them.
struct Stream(VecDeque<Result<u16, Overrun>>);

impl SenseStream for Stream {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn take_block(
        &mut self,
        _: Range<usize>,
        codes: &mut [[u16; BLOCK]; INPUTS],
    ) -> Option<Result<(), Overrun>> {
        Some(self.0.pop_front()?.map(|code| codes[0] = [code; BLOCK]))
    }
}

#[test]
fn lost_blocks_are_counted_and_take_up_their_indices() {
    let lost = Err(Overrun { blocks: 3 });
    let mut stream = Stream([Ok(100), lost, Ok(200), Ok(300), lost].into());
    let values = Values::new();
    let mut listener = Listener::starting_at(1280, &values);
    let tones = [ToneBlock::steady(1 << 60, 1); TONES];
    let begin = 1280 + 4 * 128;
    let window = Window { begin, blocks: 2, shape: Shape::Rectangular, slots: 1, input: None };
    listener.lock_in.start(window, listener.next()).expect("it can be measured");
    let recipe = Recipe { begin: begin + 100, input: 0, log2_codes: 0, values: 100 };
    listener.capture.start(recipe, listener.next(), stream.inputs()).expect("it can be made");
    let mut nexts = std::vec![listener.next()];
    loop {
        let index = listener.next();
        listener.history.record(index, &[(index << 60); TONES], &tones);
        if !listener.listen(&mut stream) {
            break;
        }
        nexts.push(listener.next());
    }
    assert_eq!(nexts, [1280, 1408, 1792, 1920, 2048, 2432]);
    assert_eq!(listener.lost_blocks(), 6);
    assert_eq!(listener.lock_in.state(), State::Finished);
    assert_eq!(listener.lock_in.reading().spans.map(|span| span.map(|span| span.highest)), [Some(300), None]);
    assert_eq!(listener.capture.progress(), Progress::Finished);
    let values: std::vec::Vec<u32> = listener.capture.values().collect();
    let (first, rest) = values.split_at(28);
    assert!(first.iter().all(|code| *code == 200) && rest.iter().all(|code| *code == 300));
}

/// A wire from the DAC's pin to the input's: each block is sampled while it is played. The input sees it `LAG` samples
/// later, at half its size.
#[derive(Clone, Default)]
struct Wire {
    played: Rc<RefCell<VecDeque<u16>>>,
    sampled: Rc<RefCell<VecDeque<[u16; BLOCK]>>>,
    room: Rc<Cell<usize>>,
}

const LAG: usize = 37;

impl DacStream for Wire {
    async fn room(&mut self) {
        core::future::poll_fn(|_| if self.room.get() > 0 { Poll::Ready(()) } else { Poll::Pending }).await;
    }

    async fn write_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        self.room.set(self.room.get() - 1);
        let mut played = self.played.borrow_mut();
        if played.is_empty() {
            played.extend([MID_SCALE; LAG]);
        }
        played.extend(codes);
        let block = core::array::from_fn(|_| (played.pop_front().unwrap() + MID_SCALE) / 2);
        self.sampled.borrow_mut().push_back(block);
        Ok(())
    }

    fn is_revisable(&self) -> bool {
        false
    }

    fn revise_block(&mut self, _: &[u16; BLOCK]) -> Result<(), Underrun> {
        Err(Underrun)
    }
}

impl SenseStream for Wire {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn take_block(
        &mut self,
        _: Range<usize>,
        codes: &mut [[u16; BLOCK]; INPUTS],
    ) -> Option<Result<(), Overrun>> {
        codes[0] = self.sampled.borrow_mut().pop_front()?;
        Some(Ok(()))
    }
}

impl Mute for Wire {
    fn set_muted(&mut self, _: bool) {}

    fn stay_on(&mut self) -> Result<(), HasMuted> {
        Ok(())
    }
}

#[test]
fn what_the_renderer_plays_is_measured_against_its_own_phase() {
    let mailbox = Mailbox::<NoopRawMutex>::new();
    let (step, level) = (0x1812_3456, Gain(Gain::FULL.0 / 4 * 3));
    for index in 0..2 {
        mailbox.write_knot(
            SlotIndex::Second,
            index,
            Knot { step: step + u32::from(index), gain: Gain::FULL },
        );
    }
    let mut renderer = Renderer::starting_at(Timing::at(400_000), 1280);
    let values = Values::new();
    let mut listener = Listener::starting_at(renderer.index(), &values);
    let window =
        Window { begin: 1280 + 100 * 128, blocks: 40, shape: Shape::Hann, slots: 1 << 3, input: None };
    listener.lock_in.start(window, listener.next()).expect("it can be measured");
    let wire = Wire::default();
    let ports = RendererPorts {
        dac: wire.clone(),
        mute: wire.clone(),
        trigger: (),
        button: (),
        cycles: (),
        sense: wire.clone(),
    };
    {
        let mut running = core::pin::pin!(renderer.run(&mailbox, ports, &mut listener));
        let mut pass = |blocks| {
            wire.room.set(blocks);
            let mut context = core::task::Context::from_waker(core::task::Waker::noop());
            assert!(running.as_mut().poll(&mut context).is_pending());
        };
        pass(1);
        mailbox.arm();
        pass(10);
        let mut targets = [None; TONES];
        targets[3] = Some(Target { position: FinePosition::default(), level, phase: 1 << 61, setting: None });
        let table = TableRef { slot: SlotIndex::Second, knots: 2 };
        let program = Program { at: mailbox.now(), glide: 2000, table, targets };
        let motion = Motion::silent().follow(&[Placement::default(); TONES], &program, mailbox.slots());
        mailbox.publish(&motion, &mailbox.view()).expect("nothing else is pending");
        pass(200);
    }
    assert_eq!((listener.lock_in.state(), listener.lost_blocks()), (State::Finished, 0));
    let reading = listener.lock_in.reading();
    assert_eq!(reading.followed, 1 << 3);
    let answer = reading.answer(0, 3).expect("it was followed");
    let scale = 4.0 / (f64::from(BASIS_ONE) * 128.0 * f64::from(reading.weight));
    let (in_phase, quadrature) = (answer.in_phase as f64 * scale, answer.quadrature as f64 * scale);
    // Half of three quarters of 2047 codes, and a phase of `LAG` samples.
    let amplitude = 2047.0 * 0.375;
    assert!((in_phase.hypot(quadrature) / amplitude - 1.0).abs() < 1e-3, "{in_phase} {quadrature}");
    let late = f64::from(step) / 2_f64.powi(32) * LAG as f64;
    let off = (quadrature.atan2(in_phase) / core::f64::consts::TAU + late + 0.5).rem_euclid(1.0) - 0.5;
    assert!(off.abs() < 1e-3, "{off} turns off");
}

#[test]
fn a_listener_that_measures_nothing_remembers_nothing_and_is_never_behind() {
    let mailbox = Mailbox::<NoopRawMutex>::new();
    let values = Values::new();
    let mut listener = Listener::starting_at(0, &values);
    let tones = [ToneBlock::steady(1 << 60, 1); TONES];
    listener.block_is_rendered(0, &[0; TONES], &tones, &mailbox);
    assert_eq!(listener.history.at(0), None);
    // Three blocks at once, as after a turn that was late.
    let mut stream = Stream([Ok(100), Ok(100), Ok(100)].into());
    listener.catch_up(&mut stream, &mailbox);
    assert_eq!(listener.next(), 3 * 128);
    // While tones are measured, a turn has time for one.
    let window = Window { begin: 3 * 128, blocks: 9, shape: Shape::Rectangular, slots: 1, input: None };
    listener.lock_in.start(window, listener.next()).expect("it can be measured");
    for index in [3, 4, 5] {
        listener.block_is_rendered(index * 128, &[(index * 128) << 60; TONES], &tones, &mailbox);
    }
    let mut stream = Stream([Ok(100), Ok(100), Ok(100)].into());
    for turn in 4..=6 {
        listener.catch_up(&mut stream, &mailbox);
        assert_eq!(listener.next(), turn * 128);
    }
    assert_eq!(listener.lock_in.reading().blocks, 3);
}

/// A stream that is asked for codes by mistake.
struct Unheard(u32);

impl SenseStream for Unheard {
    fn inputs(&self) -> usize {
        2
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn take_block(&mut self, _: Range<usize>, _: &mut [[u16; BLOCK]; INPUTS]) -> Option<Result<(), Overrun>> {
        unreachable!("nobody listens")
    }

    fn skip_block(&mut self) -> Option<Result<(), Overrun>> {
        self.0 = self.0.checked_sub(1)?;
        Some(if self.0 == 2 { Err(Overrun { blocks: 4 }) } else { Ok(()) })
    }
}

#[test]
fn without_a_listener_blocks_are_counted_and_not_copied() {
    let values = Values::new();
    let mut listener = Listener::starting_at(256, &values);
    let mut stream = Unheard(5);
    while listener.listen(&mut stream) {}
    assert_eq!((listener.next(), listener.lost_blocks()), (256 + 8 * 128, 4));
}

#[test]
fn a_measurement_that_waits_for_a_lost_block_breaks_without_a_further_block() {
    let values = Values::new();
    let mut listener = Listener::starting_at(0, &values);
    let mut stream = Stream(std::vec![Err(Overrun { blocks: 1 }); 3].into());
    let window = Window { begin: 256, blocks: 2, shape: Shape::Rectangular, slots: 1, input: None };
    listener.lock_in.start(window, 0).expect("it can be measured");
    let recipe = Recipe { begin: 300, input: 0, log2_codes: 0, values: 100 };
    listener.capture.start(recipe, 0, 1).expect("it can be made");
    for lost in 1..=3 {
        assert!(listener.listen(&mut stream));
        let waits = lost < 3;
        assert_eq!(listener.lock_in.state() == State::Measuring, waits, "{lost} blocks are lost");
        assert_eq!(listener.capture.progress() == Progress::Running, waits);
    }
    assert_eq!(listener.lock_in.state(), State::Broken { at: 256 });
    assert_eq!(listener.capture.progress(), Progress::Broken { at: 300 });
}
