//! The progress of a long computation, as a bar on the error stream. Shown only if that is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use slipline_link::DeviceTable;
use slipline_model::field::simulation::{self, SimulationError};
use slipline_plate::{DriveTable, Plate, Progress};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Shortest computation with a progress bar.
const PATIENCE: Duration = Duration::from_millis(500);
/// Steps of a bar: finer than the resolution of a terminal.
const STEPS: u64 = 1000;

/// The bar on the terminal, so that the code that ends the program can remove it.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn shown() -> MutexGuard<'static, Option<ProgressBar>> {
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the bar from the terminal, so that the next output begins on an empty line.
fn wipe(shown: &mut Option<ProgressBar>) {
    if let Some(bar) = shown.take() {
        bar.finish_and_clear();
    }
}

/// Removes the bar from the terminal and prevents further ones: for the code that ends the program.
pub(super) fn wipe_for_good() {
    let mut shown = shown();
    wipe(&mut shown);
    // Never unlocked again: a computation that still runs waits for the lock instead of showing its bar.
    std::mem::forget(shown);
}

/// Shows a bar, if the error stream is a terminal.
fn show(bar: &ProgressBar) {
    let mut shown = shown();
    bar.set_draw_target(ProgressDrawTarget::stderr());
    *shown = Some(bar.clone());
}

/// Runs a computation that reports its progress. Ctrl-C ends it like any program.
pub(super) fn watched<R>(what: &'static str, compute: impl FnOnce(&mut Progress<'_>) -> R) -> R {
    let bar = ProgressBar::hidden().with_message(what);
    bar.set_length(STEPS);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:40} {percent:>3} %, {eta} left") {
        bar.set_style(style);
    }
    let began = Instant::now();
    let mut is_shown = false;
    let result = compute(&mut Progress::new(&mut |share| {
        bar.set_position((STEPS as f64 * share) as u64);
        if !is_shown && began.elapsed() > PATIENCE {
            is_shown = true;
            show(&bar);
        }
        true
    }));
    wipe(&mut shown());
    result
}

/// Runs a procedure that reports its progress, 0 to 1, and that nothing but its device ends early.
pub(super) fn reported<R>(what: &'static str, run: impl FnOnce(&mut dyn FnMut(f64)) -> R) -> R {
    watched(what, |progress| {
        run(&mut |share| {
            // The bar never requests an early end.
            let _ = progress.at(share);
        })
    })
}

/// [`simulation::table_for`] with a progress bar.
pub(super) fn table_for(
    plate: &Plate,
    sample_rate_hz: u32,
) -> Result<(DriveTable, Arc<DeviceTable>), SimulationError> {
    watched("table", |progress| simulation::table_for_watched(plate, sample_rate_hz, progress))
}
