//! Work that takes longer than a frame, off the UI thread. Only the newest job counts; every job can be cancelled.

pub mod check;
pub mod compare;
pub mod design;
mod latest_result;
pub mod measured_places;
pub mod plane;
pub mod table;
pub mod texture;

pub use latest_result::LatestResult;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;

/// The progress of a running job, and whether its result is still wanted.
#[derive(Debug, Default)]
pub struct Task {
    /// The share done, in millionths.
    millionths: AtomicU32,
    is_over: AtomicBool,
    /// Passes each share on, to where this task cannot be seen.
    pass_on: Option<fn(f64)>,
}

impl Task {
    /// A task whose shares are passed on, such as from a worker of a browser.
    #[must_use]
    pub fn passing_on(pass_on: fn(f64)) -> Self {
        Self { pass_on: Some(pass_on), ..Self::default() }
    }

    /// Reports that this share (0..=1) is done; returns whether to continue.
    pub fn report(&self, share: f64) -> bool {
        self.millionths.store((share.clamp(0.0, 1.0) * 1e6) as u32, Ordering::Relaxed);
        if let Some(pass_on) = self.pass_on {
            pass_on(share);
        }
        !self.is_over()
    }

    /// Whether the job must end now, because it was cancelled or a newer one was requested.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    fn end(&self) {
        self.is_over.store(true, Ordering::Relaxed);
    }

    fn share(&self) -> f32 {
        self.millionths.load(Ordering::Relaxed) as f32 * 1e-6
    }
}

/// Runs jobs of one kind, one at a time, and keeps the newest result.
///
/// [`JobQueue::threaded`] runs them on its own thread; [`JobQueue::inline`] runs them at once on the caller's
/// thread, which makes tests repeatable; [`JobQueue::elsewhere`] hands them on, such as to a worker of a browser.
/// The work returns `None` if a job has no result, for example because
/// its [`Task`] was cancelled. A job that panics on the thread has no result either, and the thread continues
/// with the next job.
pub struct JobQueue<Job, Done> {
    runner: Runner<Job, Done>,
    done: Arc<Mutex<Finished<Done>>>,
    task: Arc<Task>,
    /// Number of the newest job.
    asked: u64,
    /// Every job up to this one has ended or was cancelled.
    ended: u64,
    /// Results of jobs up to this one are discarded.
    unwanted: u64,
}

/// The work that turns a job into its result.
type Work<Job, Done> = dyn FnMut(Job, &Task) -> Option<Done>;

enum Runner<Job, Done> {
    Inline(Box<Work<Job, Done>>),
    Elsewhere(Box<HandOn<Job>>),
}

/// Hands a job on: its number, the job, and its task.
type HandOn<Job> = dyn FnMut(u64, Job, Arc<Task>);

/// Numbers and results of jobs that have ended.
type Finished<Done> = Vec<(u64, Option<Done>)>;

/// Takes the results of the jobs of a queue. A list under a lock and no channel: the standard library's channel is compiled again
/// for each kind of job.
pub struct Results<Done>(Weak<Mutex<Finished<Done>>>);

impl<Done> Results<Done> {
    /// Passes on the result of the job of this number, `None` where it has none; returns whether the queue still exists.
    pub fn send(&self, number: u64, done: Option<Done>) -> bool {
        let queue = self.0.upgrade();
        if let Some(queue) = &queue {
            lock(queue).push((number, done));
        }
        queue.is_some()
    }
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<Job: Send + 'static, Done: Send + 'static> JobQueue<Job, Done> {
    /// Runs jobs on a thread named `name` and calls `wake` after each. The thread ends when the queue is dropped.
    ///
    /// # Errors
    /// The error of the system when it cannot start a thread.
    #[cfg_attr(
        not(test),
        expect(
            clippy::disallowed_methods,
            reason = "a thread of its own: a browser uses [`JobQueue::inline`]"
        )
    )]
    pub fn threaded(
        name: &str,
        mut work: impl FnMut(Job, &Task) -> Option<Done> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let (jobs, queue) = channel::<(u64, Job, Arc<Task>)>();
        // If the thread has ended, there is no result; the rest of the app stays usable.
        let (this, finished) = Self::elsewhere(move |number, job, task| drop(jobs.send((number, job, task))));
        let queue_name = name.to_owned();
        thread::Builder::new().name(name.to_owned()).spawn(move || {
            while let Ok(mut next) = queue.recv() {
                // Newer jobs make the older ones obsolete.
                while let Ok(newer) = queue.try_recv() {
                    next = newer;
                }
                let (number, job, task) = next;
                tracing::debug!("{queue_name}: job {number} begins");
                let done = catch_unwind(AssertUnwindSafe(|| work(job, &task))).unwrap_or(None);
                let end = if done.is_some() { "is done" } else { "was cancelled or failed" };
                tracing::debug!("{queue_name}: job {number} {end}");
                if !finished.send(number, done) {
                    return;
                }
                wake();
            }
        })?;
        Ok(this)
    }

    /// Runs every job at once, on the caller's thread.
    #[must_use]
    pub fn inline(work: impl FnMut(Job, &Task) -> Option<Done> + 'static) -> Self {
        Self::new(Runner::Inline(Box::new(work)))
    }

    /// Forwards each numbered job; the executor sends back the number and the result, or `None`. Once a task is over, nobody
    /// needs its result.
    #[must_use]
    pub fn elsewhere(hand_on: impl FnMut(u64, Job, Arc<Task>) + 'static) -> (Self, Results<Done>) {
        let queue = Self::new(Runner::Elsewhere(Box::new(hand_on)));
        let results = Results(Arc::downgrade(&queue.done));
        (queue, results)
    }

    fn new(runner: Runner<Job, Done>) -> Self {
        Self { runner, done: Arc::default(), task: Arc::default(), asked: 0, ended: 0, unwanted: 0 }
    }

    /// Requests a job. The task of an older job that still runs is ended.
    pub fn ask(&mut self, job: Job) {
        self.task.end();
        self.task = Arc::default();
        self.asked += 1;
        match &mut self.runner {
            Runner::Inline(work) => {
                let done = work(job, &self.task);
                lock(&self.done).push((self.asked, done));
            }
            Runner::Elsewhere(hand_on) => hand_on(self.asked, job, Arc::clone(&self.task)),
        }
    }

    /// The newest result since the last call.
    pub fn take(&mut self) -> Option<Done> {
        self.take_numbered().map(|(_, done)| done)
    }

    /// The newest result since the last call, with the number of its job.
    fn take_numbered(&mut self) -> Option<(u64, Done)> {
        let mut newest = None;
        let finished = std::mem::take(&mut *lock(&self.done));
        for (number, done) in finished {
            self.ended = self.ended.max(number);
            if number > self.unwanted {
                newest = done.map(|done| (number, done)).or(newest);
            }
        }
        newest
    }

    /// The share of the newest job that is done, 0..=1; `None` while no job runs.
    #[must_use]
    pub fn progress(&self) -> Option<f32> {
        (self.ended < self.asked).then(|| self.task.share())
    }

    /// Cancels the present job: its result is dropped, even if it is ready by now.
    pub fn cancel(&mut self) {
        self.task.end();
        self.ended = self.asked;
        self.unwanted = self.asked;
    }
}

/// A queue that does nothing: no job has a result.
impl<Job: Send + 'static, Done: Send + 'static> Default for JobQueue<Job, Done> {
    fn default() -> Self {
        Self::inline(|_, _| None)
    }
}

impl<Job, Done> Drop for JobQueue<Job, Done> {
    fn drop(&mut self) {
        self.task.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_job_is_done_and_the_caller_is_woken() {
        let (woken, waking) = channel();
        let mut queue =
            JobQueue::threaded("test", |n: u32, _| Some(n * 2), move || woken.send(()).unwrap_or_default())
                .unwrap();
        for n in 1..=5 {
            queue.ask(n);
        }
        let mut latest = None;
        while latest != Some(10) {
            waking.recv().unwrap();
            latest = queue.take().or(latest);
        }
        assert_eq!(queue.progress(), None);
    }

    #[test]
    fn a_job_that_panics_ends_and_the_next_one_is_done() {
        let (woken, waking) = channel();
        let work = |fails: bool, _: &Task| {
            assert!(!fails, "a mistake in the work");
            Some(7)
        };
        let mut queue = JobQueue::threaded("test", work, move || woken.send(()).unwrap_or_default()).unwrap();
        for (fails, done) in [(true, None), (false, Some(7))] {
            queue.ask(fails);
            waking.recv().unwrap();
            assert_eq!(queue.take(), done);
            assert_eq!(queue.progress(), None);
        }
    }

    #[test]
    fn inline_work_is_done_when_asked() {
        let mut queue = JobQueue::inline(|n: u32, _| Some(n + 1));
        queue.ask(1);
        queue.ask(2);
        assert_eq!(queue.take(), Some(3));
        assert_eq!(queue.take(), None);
    }

    #[test]
    fn a_job_that_is_done_elsewhere_is_the_newest_and_a_cancelled_one_is_not_wanted() {
        let (handed, given) = channel();
        let (mut queue, finished) = JobQueue::<u32, u32>::elsewhere(move |number, job, task| {
            handed.send((number, job, task)).unwrap();
        });
        queue.ask(1);
        queue.ask(2);
        let [(first, _, older), (second, job, newer)] = [given.recv().unwrap(), given.recv().unwrap()];
        assert!(older.is_over() && newer.report(0.25) && job == 2);
        assert_eq!(queue.progress(), Some(0.25));
        assert!(finished.send(first, None));
        assert_eq!((queue.take(), queue.progress()), (None, Some(0.25)));
        assert!(finished.send(second, Some(20)));
        assert_eq!((queue.take(), queue.progress()), (Some(20), None));
        queue.ask(3);
        queue.cancel();
        let (third, _, task) = given.recv().unwrap();
        assert!(task.is_over());
        assert!(finished.send(third, Some(30)));
        assert_eq!((queue.take(), queue.progress()), (None, None));
        drop(queue);
        assert!(!finished.send(4, None), "nobody takes it");
    }

    #[test]
    fn a_task_passes_each_share_on() {
        thread_local! {
            static SHARES: std::cell::RefCell<Vec<f64>> = const { std::cell::RefCell::new(Vec::new()) };
        }
        let task = Task::passing_on(|share| SHARES.with_borrow_mut(|shares| shares.push(share)));
        assert!(task.report(0.25) && task.report(1.0));
        assert_eq!(SHARES.take(), [0.25, 1.0]);
    }

    #[test]
    fn a_cancelled_job_ends_without_a_result() {
        let (half_way, reported) = channel();
        let (woken, waking) = channel();
        let work = move |forever: bool, task: &Task| {
            while forever && task.report(0.5) {
                half_way.send(()).unwrap_or_default();
                thread::yield_now();
            }
            Some(forever)
        };
        let mut queue = JobQueue::threaded("test", work, move || woken.send(()).unwrap_or_default()).unwrap();
        queue.ask(true);
        reported.recv().unwrap();
        assert_eq!(queue.progress(), Some(0.5));
        queue.cancel();
        assert_eq!(queue.progress(), None);
        waking.recv().unwrap();
        assert_eq!(queue.take(), None, "it did end, and is not wanted");
        // A newer job ends an older one, too.
        queue.ask(true);
        queue.ask(false);
        let mut latest = None;
        while latest != Some(false) {
            waking.recv().unwrap();
            latest = queue.take().or(latest);
        }
    }
}
