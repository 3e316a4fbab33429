//! How far a long computation is, as a bar on a terminal's error stream; nothing where there is no terminal to look at
//! it.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use slipline_link::table::DeviceTable;
use slipline_model::field::simulation::{self, SimulationError};
use slipline_plate::{DriveTable, Plate, Progress};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What takes no longer than this is not talked about.
const PATIENCE: Duration = Duration::from_millis(500);
/// Steps of a bar: finer than a terminal shows.
const STEPS: u64 = 1000;

/// The bar that is on the terminal, for whoever ends the program.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Takes the bar off the terminal: whatever is written next begins on an empty line.
pub(super) fn wipe() {
    if let Some(bar) = SHOWN.lock().unwrap_or_else(PoisonError::into_inner).take() {
        bar.finish_and_clear();
    }
}

/// Shows a bar, if the error stream is a terminal.
fn show(bar: &ProgressBar) {
    bar.set_draw_target(ProgressDrawTarget::stderr());
    *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
}

/// Does a computation that tells how far it is. Ctrl-C ends it as it ends any program.
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
    wipe();
    result
}

/// [`simulation::table_for`], watched.
pub(super) fn table_for(
    plate: &Plate,
    sample_rate_hz: u32,
) -> Result<(DriveTable, Arc<DeviceTable>), SimulationError> {
    watched("table", |progress| simulation::table_for_watched(plate, sample_rate_hz, progress))
}
