//! Commands that measure the inputs: orders to the listener, and reads of its results.

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;
use slipline_dds::lock_in::{Shape, Span, State, Window};
use slipline_protocol::Event;
use slipline_protocol::limits::{
    CAPTURED_VALUES, LISTENED_TONES, MAX_CAPTURE_LOG2, MAX_CAPTURE_VALUES, MAX_TONES,
};
use slipline_protocol::listen::{
    CapturePart, CaptureWindow, Captured, InPhaseQuadrature, InputsReport, ListenPart, ListenWindow,
    Listened, Progress, WindowShape,
};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::units::SampleIndex;

use super::Controller;
use crate::listening::capture::Recipe;
use crate::mailbox::{Inputs, Mailbox};
use crate::ports::{FlashPages, System};
use crate::range::in_range;
use crate::timing::block_at_or_after;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Begins a measurement; returns its first sample.
    pub(super) fn listen<M: RawMutex>(
        &mut self,
        asked: &ListenWindow,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let inputs = existing(mailbox)?;
        self.refresh_hold(mailbox);
        self.refuse_if_holding()?;
        in_range(Field::WindowBlocks, 1, u16::MAX.into(), asked.blocks.into())?;
        asked.input.map_or(Ok(()), |input| check_input(input, inputs))?;
        let measured = if asked.input.is_some() { 1 } else { inputs.count };
        let most = inputs.lock_ins.checked_div(measured).unwrap_or(0);
        in_range(Field::LockIns, 0, most as u64, asked.slots.count_ones().into())?;
        let shape = match asked.shape {
            WindowShape::Rectangular => Shape::Rectangular,
            WindowShape::Hann => Shape::Hann,
        };
        mailbox.start_measurement(|next| {
            let begin = block_at_or_after(self.ahead(asked.from, next)?);
            let window =
                Window { begin, blocks: asked.blocks, shape, slots: asked.slots, input: asked.input };
            window.check(next).map_err(|_| beyond_time(next, begin))?;
            Ok(window)
        })
    }

    /// Begins a capture; returns the index of its first code.
    pub(super) fn capture<M: RawMutex>(
        &self,
        asked: &CaptureWindow,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let inputs = existing(mailbox)?;
        check_input(asked.input, inputs)?;
        in_range(Field::CaptureCodes, 0, MAX_CAPTURE_LOG2.into(), asked.log2_codes.into())?;
        in_range(Field::CaptureValues, 1, MAX_CAPTURE_VALUES.into(), asked.values.into())?;
        mailbox.start_capture(|next| {
            let begin = self.ahead(asked.from, next)?;
            let CaptureWindow { input, log2_codes, values, .. } = *asked;
            let recipe = Recipe { begin, input, log2_codes, values };
            recipe.check(next, inputs.count).map_err(|_| beyond_time(next, begin))?;
            Ok(recipe)
        })
    }

    /// Reads values of the capture.
    pub(super) fn captured<M: RawMutex>(
        &self,
        part: CapturePart,
        mailbox: &Mailbox<M>,
    ) -> Result<Event, Refusal> {
        existing(mailbox)?;
        let capture = mailbox.captured();
        let first = usize::from(part.first);
        let count = capture.filled.saturating_sub(first).min(CAPTURED_VALUES);
        Ok(Event::Captured(Captured {
            progress: capture.progress,
            from: capture.begin,
            captured: u16::try_from(capture.filled).unwrap_or(u16::MAX),
            first: part.first,
            values: self.captured.range(first, count).collect(),
        }))
    }

    /// The index that is asked for, which must not lie too far ahead, or the next one.
    fn ahead(&self, from: Option<SampleIndex>, next: SampleIndex) -> Result<SampleIndex, Refusal> {
        let Some(from) = from else { return Ok(next) };
        in_range(Field::ApplyAt, next, next.saturating_add(self.timing.max_apply_ahead), from)?;
        Ok(from)
    }
}

/// Number, lock-ins, delay and lost blocks of the inputs.
pub(super) fn inputs<M: RawMutex>(mailbox: &Mailbox<M>) -> Event {
    let Inputs { count, lock_ins, delay_ns, lost_blocks } = mailbox.inputs();
    let lock_ins = if count == 0 { 0 } else { lock_ins };
    Event::Inputs(InputsReport {
        inputs: u8::try_from(count).unwrap_or(u8::MAX),
        lock_ins: u8::try_from(lock_ins).unwrap_or(u8::MAX),
        delay_ns: delay_ns.into(),
        lost_blocks,
        now: mailbox.now(),
    })
}

/// Reads a part of the measurement.
pub(super) fn listened<M: RawMutex>(part: ListenPart, mailbox: &Mailbox<M>) -> Result<Event, Refusal> {
    check_input(part.input, existing(mailbox)?)?;
    in_range(Field::ToneSlot, 0, (MAX_TONES as u64).saturating_sub(1), part.first_slot.into())?;
    let measurement = mailbox.measurement();
    let input = usize::from(part.input);
    let progress = match measurement.state {
        State::Idle => Progress::Idle,
        State::Measuring => Progress::Running,
        State::Finished => Progress::Finished,
        State::Broken { at } => Progress::Broken { at },
    };
    let mut answers = Vec::new();
    if matches!(progress, Progress::Finished | Progress::Broken { .. }) {
        for slot in (usize::from(part.first_slot)..MAX_TONES).take(LISTENED_TONES) {
            let answer =
                mailbox.answer(&measurement, input, slot).map_or_else(InPhaseQuadrature::default, |answer| {
                    InPhaseQuadrature { in_phase: answer.in_phase, quadrature: answer.quadrature }
                });
            // There is room: just as many are taken.
            let _ = answers.push(answer);
        }
    }
    let span = measurement.spans.get(input).copied().flatten().unwrap_or(Span { lowest: 0, highest: 0 });
    Ok(Event::Listened(Listened {
        progress,
        begin: measurement.begin,
        blocks: measurement.blocks,
        weight: measurement.weight,
        followed: measurement.followed,
        lowest: span.lowest,
        highest: span.highest,
        answers,
    }))
}

/// The inputs of a device that has any.
pub(super) fn existing<M: RawMutex>(mailbox: &Mailbox<M>) -> Result<Inputs, Refusal> {
    Some(mailbox.inputs()).filter(|inputs| inputs.count > 0).ok_or(Refusal::NotSupported)
}

pub(super) fn check_input(input: u8, inputs: Inputs) -> Result<(), Refusal> {
    in_range(Field::Input, 0, (inputs.count as u64).saturating_sub(1), input.into())
}

/// The refusal of a window or capture that would end after the last sample index.
fn beyond_time(next: SampleIndex, begin: SampleIndex) -> Refusal {
    let signed = |index| i64::try_from(index).unwrap_or(i64::MAX);
    Refusal::out_of_range(Field::ApplyAt, signed(next), i64::MAX, signed(begin))
}
