//! Orders from the thread side to the listener, and the listener's reports.
//!
//! ```text
//! thread side                Mailbox                interrupt side (listener)
//! start, stop         --> order, "running"   ---->  takes the order with the next block, reports nothing before
//! measurement, answer <-- progress, reading  <----  progress every block, the reading once, at the window's end
//! ```
//! A reading is reported once and stays unchanged until the thread side's next order. So it is written and read in parts,
//! each under the lock for some hundred bytes at most.

use core::cell::Cell;

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_dds::bank::TONES;
use slipline_dds::lock_in::{self, InPhaseQuadrature, Reading, Span, State, Window};
use slipline_protocol::listen::Progress;
use slipline_protocol::units::SampleIndex;

use super::Mailbox;
use crate::listening::capture::Recipe;
use crate::ports::INPUTS;

/// An order for a measurement or a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order<T> {
    /// A new one begins.
    Start(T),
    /// It ends, and keeps what it has.
    Stop,
    /// It ends and is forgotten.
    Drop,
}

/// New orders for the listener; `None`: no change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ListenOrders {
    pub(crate) measurement: Option<Order<Window>>,
    pub(crate) capture: Option<Order<Recipe>>,
}

/// The board's inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Number of inputs.
    pub count: usize,
    /// Tones that can be measured at once.
    pub lock_ins: usize,
    /// Delay from a DAC code to the input's sample-and-hold.
    pub delay_ns: i32,
    /// Blocks that were lost since the start.
    pub lost_blocks: u32,
}

/// A measurement without its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeasurementReport {
    /// Its progress.
    pub state: State,
    /// Its first sample.
    pub begin: SampleIndex,
    /// Blocks that have been taken.
    pub blocks: u16,
    /// The sum of their weights; 0 while it is under way, as all that follows.
    pub weight: u32,
    /// As [`Reading::followed`].
    pub followed: u16,
    /// As [`Reading::spans`].
    pub spans: [Option<Span>; INPUTS],
    codes: [i64; INPUTS],
}

impl MeasurementReport {
    const NONE: Self = Self::begun(0, State::Idle);

    const fn begun(begin: SampleIndex, state: State) -> Self {
        Self { state, begin, blocks: 0, weight: 0, followed: 0, spans: [None; INPUTS], codes: [0; INPUTS] }
    }
}

/// A capture without its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CaptureReport {
    /// Its progress.
    pub progress: Progress,
    /// The index of its first code.
    pub begin: SampleIndex,
    /// Number of values.
    pub filled: usize,
}

impl CaptureReport {
    const NONE: Self = Self { progress: Progress::Idle, begin: 0, filled: 0 };
}

/// The sums of all slots.
type Sums = [InPhaseQuadrature; TONES];

/// Orders and results, guarded by the mailbox's lock.
pub(super) struct Listening {
    /// Whether there is an order.
    is_ordered: Cell<bool>,
    measurement_order: Cell<Option<Order<Window>>>,
    capture_order: Cell<Option<Order<Recipe>>>,
    inputs: Cell<Inputs>,
    measurement: Cell<MeasurementReport>,
    sums: [Cell<Sums>; INPUTS],
    constant: Cell<Sums>,
    captured: Cell<CaptureReport>,
}

impl Listening {
    pub(super) const fn new() -> Self {
        const NOTHING: Sums = [InPhaseQuadrature { in_phase: 0, quadrature: 0 }; TONES];
        Self {
            is_ordered: Cell::new(false),
            measurement_order: Cell::new(None),
            capture_order: Cell::new(None),
            inputs: Cell::new(Inputs { count: 0, lock_ins: 0, delay_ns: 0, lost_blocks: 0 }),
            measurement: Cell::new(MeasurementReport::NONE),
            sums: [const { Cell::new(NOTHING) }; INPUTS],
            constant: Cell::new(NOTHING),
            captured: Cell::new(CaptureReport::NONE),
        }
    }

    fn order_measurement(&self, order: Order<Window>, until_taken: MeasurementReport) {
        self.measurement_order.set(Some(order));
        self.measurement.set(until_taken);
        self.is_ordered.set(true);
    }

    fn order_capture(&self, order: Order<Recipe>, until_taken: CaptureReport) {
        self.capture_order.set(Some(order));
        self.captured.set(until_taken);
        self.is_ordered.set(true);
    }
}

/// The thread side.
impl<M: RawMutex> Mailbox<M> {
    /// The board's inputs.
    pub fn inputs(&self) -> Inputs {
        self.shared.lock(|shared| shared.listening.inputs.get())
    }

    /// Begins the measurement that `window` makes for the first index that is not rendered yet, and forgets the last one. One
    /// step, so that the window has not begun when the renderer sees it. Returns the window's first sample.
    ///
    /// # Errors
    /// What `window` says.
    pub fn start_measurement<E>(
        &self,
        window: impl FnOnce(SampleIndex) -> Result<Window, E>,
    ) -> Result<SampleIndex, E> {
        self.shared.lock(|shared| {
            let window = window(shared.next.get())?;
            let begun = MeasurementReport::begun(window.begin, State::Measuring);
            shared.listening.order_measurement(Order::Start(window), begun);
            Ok(window.begin)
        })
    }

    /// Drops the measurement.
    pub fn drop_measurement(&self) {
        self.shared.lock(|shared| shared.listening.order_measurement(Order::Drop, MeasurementReport::NONE));
    }

    /// The measurement's state.
    pub fn measurement(&self) -> MeasurementReport {
        self.shared.lock(|shared| shared.listening.measurement.get())
    }

    /// As [`Reading::answer`], of a `measurement` that is over.
    pub fn answer(
        &self,
        measurement: &MeasurementReport,
        input: usize,
        slot: usize,
    ) -> Option<InPhaseQuadrature> {
        measurement.spans.get(input).copied().flatten()?;
        if measurement.followed & 1_u16.checked_shl(u32::try_from(slot).ok()?)? == 0 {
            return None;
        }
        let codes = *measurement.codes.get(input)?;
        let (sum, constant) = self.shared.lock(|shared| {
            let sums = shared.listening.sums.get(input)?.get();
            let constants = shared.listening.constant.get();
            Some((*sums.get(slot)?, *constants.get(slot)?))
        })?;
        lock_in::without_offset(sum, constant, codes, measurement.weight)
    }

    /// Begins the capture that `recipe` makes for the first index that is not rendered yet, as
    /// [`Mailbox::start_measurement`] a measurement.
    ///
    /// # Errors
    /// What `recipe` says.
    pub fn start_capture<E>(
        &self,
        recipe: impl FnOnce(SampleIndex) -> Result<Recipe, E>,
    ) -> Result<SampleIndex, E> {
        self.shared.lock(|shared| {
            let recipe = recipe(shared.next.get())?;
            let progress = Progress::Running;
            let begun = CaptureReport { progress, begin: recipe.begin, filled: 0 };
            shared.listening.order_capture(Order::Start(recipe), begun);
            Ok(recipe.begin)
        })
    }

    /// Ends the capture. [`Mailbox::captured`] shows the end only when the listener has taken the order.
    pub fn stop_capture(&self) {
        self.shared.lock(|shared| {
            let listening = &shared.listening;
            match listening.capture_order.get() {
                // It has not begun.
                Some(Order::Start(_) | Order::Drop) => {
                    listening.order_capture(Order::Drop, CaptureReport::NONE);
                }
                _ => listening.order_capture(Order::Stop, listening.captured.get()),
            }
        });
    }

    /// The capture's state.
    pub fn captured(&self) -> CaptureReport {
        self.shared.lock(|shared| shared.listening.captured.get())
    }

    /// Drops measurement and capture.
    pub fn drop_listening(&self) {
        self.drop_measurement();
        self.shared.lock(|shared| shared.listening.order_capture(Order::Drop, CaptureReport::NONE));
    }
}

/// The interrupt side.
impl<M: RawMutex> Mailbox<M> {
    /// Sets the board's inputs.
    pub(crate) fn set_inputs(&self, inputs: Inputs) {
        self.shared.lock(|shared| shared.listening.inputs.set(inputs));
    }

    /// Takes what the listener is to do. After [`Mailbox::begin_block`]: a window that begins with this block has been ordered
    /// before that.
    pub(crate) fn take_listen_orders(&self) -> Option<ListenOrders> {
        self.shared.lock(|shared| {
            let listening = &shared.listening;
            listening.is_ordered.take().then(|| ListenOrders {
                measurement: listening.measurement_order.take(),
                capture: listening.capture_order.take(),
            })
        })
    }

    /// Counts lost blocks.
    pub(crate) fn set_lost_blocks(&self, lost_blocks: u32) {
        self.shared.lock(|shared| {
            let inputs = &shared.listening.inputs;
            inputs.set(Inputs { lost_blocks, ..inputs.get() });
        });
    }

    /// Reports how many blocks of a measurement have been taken.
    pub(crate) fn set_measured_blocks(&self, blocks: u16) {
        self.shared.lock(|shared| {
            let listening = &shared.listening;
            if listening.measurement_order.get().is_none() {
                let last = listening.measurement.get();
                listening.measurement.set(MeasurementReport { blocks, ..last });
            }
        });
    }

    /// Reports the reading of a measurement that is over, unless there is a new order.
    pub(crate) fn set_reading(&self, state: State, begin: SampleIndex, reading: &Reading<INPUTS>) {
        for (cell, sums) in (0..INPUTS).zip(&reading.sums) {
            self.shared.lock(|shared| {
                if let Some(cell) = shared.listening.sums.get(cell) {
                    cell.set(*sums);
                }
            });
        }
        self.shared.lock(|shared| shared.listening.constant.set(reading.constant));
        self.shared.lock(|shared| {
            if shared.listening.measurement_order.get().is_none() {
                shared.listening.measurement.set(MeasurementReport {
                    state,
                    begin,
                    blocks: reading.blocks,
                    weight: reading.weight,
                    followed: reading.followed,
                    spans: reading.spans,
                    codes: reading.codes,
                });
            }
        });
    }

    /// Reports the capture's state, unless there is a new order.
    pub(crate) fn set_captured(&self, captured: CaptureReport) {
        self.shared.lock(|shared| {
            if shared.listening.capture_order.get().is_none() {
                shared.listening.captured.set(captured);
            }
        });
    }
}
