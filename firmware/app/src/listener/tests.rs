//! The listener on a stream that loses blocks.
extern crate std;

use super::*;
use crate::bank::{TONES, ToneBlock};
use crate::capture::{Progress, Recipe};
use crate::lock_in::{Shape, State, Window};
use std::collections::VecDeque;

/// Blocks of one input, each of one code, and the losses between them.
struct Stream(VecDeque<Result<u16, Overrun>>);

impl SenseStream for Stream {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn take_block(&mut self, codes: &mut [[u16; BLOCK]; INPUTS]) -> Option<Result<(), Overrun>> {
        Some(self.0.pop_front()?.map(|code| codes[0] = [code; BLOCK]))
    }
}

#[test]
fn lost_blocks_are_counted_and_take_up_their_indices() {
    let lost = Err(Overrun { blocks: 3 });
    let mut stream = Stream([Ok(100), lost, Ok(200), Ok(300), lost].into());
    let mut listener = Listener::starting_at(1280);
    let tones = [ToneBlock::steady(1 << 60, 1); TONES];
    let begin = 1280 + 4 * 128;
    let window = Window { begin, blocks: 2, shape: Shape::Rectangular, slots: 1 };
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
    let (first, rest) = listener.capture.values().split_at(28);
    assert!(first.iter().all(|code| *code == 200) && rest.iter().all(|code| *code == 300));
}
