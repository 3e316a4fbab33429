//! How far a long computation is, on a terminal's error stream; nothing where there is no terminal to look at it.

use slipline_link::table::DeviceTable;
use slipline_model::field::simulation::{self, SimulationError};
use slipline_plate::{DriveTable, Plate, Progress};
use std::io::{self, IsTerminal, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What takes no longer than this is not talked about.
const PATIENCE: Duration = Duration::from_millis(500);

/// A line that is written anew as the share grows, and gone in the end.
struct Line<W> {
    out: W,
    what: &'static str,
    shown: Option<u32>,
}

impl<W: Write> Line<W> {
    fn tell(&mut self, share: f64) {
        let percent = (100.0 * share) as u32;
        if self.shown != Some(percent) {
            self.shown = Some(percent);
            // A line that cannot be written is no reason to stop the work.
            let _ = write!(self.out, "\r{} {percent:3} %", self.what).and_then(|()| self.out.flush());
        }
    }

    fn wipe(&mut self) {
        if self.shown.is_some() {
            let _ = write!(self.out, "\r\x1b[K").and_then(|()| self.out.flush());
        }
    }
}

/// Does a computation that tells how far it is. Ctrl-C ends it as it ends any program.
pub(super) fn watched<R>(what: &'static str, compute: impl FnOnce(&mut Progress<'_>) -> R) -> R {
    let is_watched = io::stderr().is_terminal();
    let mut line = Line { out: io::stderr(), what, shown: None };
    let began = Instant::now();
    let result = compute(&mut Progress::new(&mut |share| {
        if is_watched && began.elapsed() > PATIENCE {
            line.tell(share);
        }
        true
    }));
    line.wipe();
    result
}

/// [`simulation::table_for`], watched.
pub(super) fn table_for(
    plate: &Plate,
    sample_rate_hz: u32,
) -> Result<(DriveTable, Arc<DeviceTable>), SimulationError> {
    watched("table", |progress| simulation::table_for_watched(plate, sample_rate_hz, progress))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_written_once_for_each_per_cent_and_wiped() {
        let mut line = Line { out: Vec::new(), what: "table", shown: None };
        for share in [0.1, 0.101, 0.5, 1.0] {
            line.tell(share);
        }
        line.wipe();
        let text = String::from_utf8(line.out).unwrap();
        assert_eq!(text, "\rtable  10 %\rtable  50 %\rtable 100 %\r\x1b[K");
    }

    #[test]
    fn what_was_not_talked_about_is_not_wiped() {
        let mut line = Line { out: Vec::new(), what: "table", shown: None };
        line.wipe();
        assert!(line.out.is_empty());
    }
}
