//! A whole study on the threads of this computer.

use super::chunk::Chunk;
use super::plates::Study;
use std::collections::BTreeMap;
use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;

/// Computes all plates in chunks of `plates_at_once` (1 and more) on `threads` threads, and gives the chunks to `take` in the
/// order of their plates, whatever the order in which they are ready. `take` returns whether to continue.
///
/// # Errors
/// The system's, when it starts no thread.
#[cfg_attr(
    not(test),
    expect(
        clippy::disallowed_methods,
        reason = "uses this computer's threads; a browser calls `Study::run_range` instead"
    )
)]
pub fn run_in_order(
    study: &Study,
    threads: usize,
    plates_at_once: u64,
    mut take: impl FnMut(Chunk) -> bool,
) -> io::Result<()> {
    let (count, plates_at_once, threads) = (study.spec().count(), plates_at_once.max(1), threads.max(1));
    let next = AtomicU64::new(0);
    let work = |sender: SyncSender<(u64, Chunk)>| {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let first = number.saturating_mul(plates_at_once);
            if first >= count {
                return;
            }
            let chunk = study.run_range(first..count.min(first.saturating_add(plates_at_once)));
            if sender.send((number, chunk)).is_err() {
                return;
            }
        }
    };
    let work = &work;
    // A thread that is far ahead of the caller waits.
    let (sender, chunks) = sync_channel(2 * threads);
    thread::scope(|scope| {
        for number in 0..threads {
            let sender = sender.clone();
            let builder = thread::Builder::new().name("slipline-study".to_owned());
            // With fewer threads than wanted the numbers are the same.
            if let Err(error) = builder.spawn_scoped(scope, move || work(sender))
                && number == 0
            {
                return Err(error);
            }
        }
        drop(sender);
        // Dropped with this closure: a thread that still sends then ends.
        let chunks = chunks;
        let mut early = BTreeMap::new();
        let mut due = 0;
        while let Ok((number, chunk)) = chunks.recv() {
            early.insert(number, chunk);
            while let Some(chunk) = early.remove(&due) {
                due += 1;
                if !take(chunk) {
                    return Ok(());
                }
            }
        }
        Ok(())
    })
}
