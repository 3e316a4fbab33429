//! Work that takes longer than a frame, off the UI thread: only the newest job counts.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

/// A place where jobs of one kind are done.
///
/// [`Workshop::threaded`] does them on a thread of its own; [`Workshop::inline`] at once, which makes tests
/// repeatable.
pub struct Workshop<Job, Done> {
    way: Way<Job, Done>,
    done: Receiver<Done>,
}

enum Way<Job, Done> {
    Thread(Sender<Job>),
    Inline(Box<dyn FnMut(Job) -> Done>, Sender<Done>),
}

impl<Job: Send + 'static, Done: Send + 'static> Workshop<Job, Done> {
    /// Does jobs on a thread named `name` and calls `wake` after each. The thread ends with the workshop.
    ///
    /// # Errors
    /// What the system says when it gives no thread.
    pub fn threaded(
        name: &str,
        mut work: impl FnMut(Job) -> Done + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let (jobs, queue) = channel::<Job>();
        let (finished, done) = channel();
        thread::Builder::new().name(name.to_owned()).spawn(move || {
            while let Ok(mut job) = queue.recv() {
                // What was asked for meanwhile makes the older jobs needless.
                while let Ok(newer) = queue.try_recv() {
                    job = newer;
                }
                if finished.send(work(job)).is_err() {
                    return;
                }
                wake();
            }
        })?;
        Ok(Self { way: Way::Thread(jobs), done })
    }

    /// Does every job at once, on the caller's thread.
    #[must_use]
    pub fn inline(work: impl FnMut(Job) -> Done + 'static) -> Self {
        let (finished, done) = channel();
        Self { way: Way::Inline(Box::new(work), finished), done }
    }

    /// Asks for a job.
    pub fn ask(&mut self, job: Job) {
        match &mut self.way {
            // A thread that has gone answers no more; the app stays usable without it.
            Way::Thread(jobs) => drop(jobs.send(job)),
            Way::Inline(work, finished) => drop(finished.send(work(job))),
        }
    }

    /// The newest result since the last call.
    pub fn take(&mut self) -> Option<Done> {
        self.done.try_iter().last()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_job_is_done_and_the_caller_is_woken() {
        let (woken, waking) = channel();
        let mut workshop =
            Workshop::threaded("test", |n: u32| n * 2, move || woken.send(()).unwrap_or_default()).unwrap();
        for n in 1..=5 {
            workshop.ask(n);
        }
        let mut latest = None;
        while latest != Some(10) {
            waking.recv().unwrap();
            latest = workshop.take().or(latest);
        }
    }

    #[test]
    fn inline_work_is_done_when_asked() {
        let mut workshop = Workshop::inline(|n: u32| n + 1);
        workshop.ask(1);
        workshop.ask(2);
        assert_eq!(workshop.take(), Some(3));
        assert_eq!(workshop.take(), None);
    }
}
