//! The result of the job that was requested last.

use super::JobQueue;

/// A queue whose result counts only for the job that was requested last.
pub struct LatestResult<Job, Done> {
    queue: JobQueue<Job, Done>,
    asked: Option<Job>,
    /// The newest result and the number of its job.
    newest: Option<(u64, Done)>,
}

impl<Job: Clone + PartialEq + Send + 'static, Done: Send + 'static> LatestResult<Job, Done> {
    /// No result yet; later ones come from this queue.
    #[must_use]
    pub const fn of(queue: JobQueue<Job, Done>) -> Self {
        Self { queue, asked: None, newest: None }
    }

    /// Requests a job, unless it equals the one requested last.
    pub fn ask(&mut self, job: Job) {
        if self.asked.as_ref() != Some(&job) {
            self.asked = Some(job.clone());
            self.queue.ask(job);
        }
    }

    /// Takes the newest result from the queue.
    pub fn take(&mut self) {
        self.newest = self.queue.take_numbered().or(self.newest.take());
    }

    /// The job requested last.
    #[must_use]
    pub const fn asked(&self) -> Option<&Job> {
        self.asked.as_ref()
    }

    /// The result of the job requested last; `None` until it is done.
    #[must_use]
    pub fn current(&self) -> Option<&Done> {
        self.newest.as_ref().filter(|(number, _)| *number == self.queue.asked).map(|(_, done)| done)
    }

    /// The newest result, even if a later job has been requested.
    #[must_use]
    pub fn newest(&self) -> Option<&Done> {
        self.newest.as_ref().map(|(_, done)| done)
    }

    /// The share of the job requested last that is done, 0..=1; `None` while no job runs.
    #[must_use]
    pub fn progress(&self) -> Option<f32> {
        self.queue.progress()
    }

    /// Cancels the present job. It is not requested again until another one was.
    pub fn cancel(&mut self) {
        self.queue.cancel();
    }

    /// Cancels the present job and forgets the results; the same job may be requested again.
    pub fn forget(&mut self) {
        self.queue.cancel();
        (self.asked, self.newest) = (None, None);
    }
}

impl<Job: Clone + PartialEq + Send + 'static, Done: Send + 'static> Default for LatestResult<Job, Done> {
    fn default() -> Self {
        Self::of(JobQueue::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn only_the_result_of_the_job_requested_last_is_current() {
        let (handed, given) = channel();
        let (queue, finished) = JobQueue::<u32, u32>::elsewhere(move |number, job, _| {
            handed.send((number, job)).unwrap();
        });
        let mut results = LatestResult::of(queue);
        results.ask(1);
        results.ask(1);
        let (first, _) = given.recv().unwrap();
        assert!(given.try_recv().is_err(), "the same job is requested once");
        results.ask(2);
        assert!(finished.send(first, Some(10)));
        results.take();
        assert_eq!((results.current(), results.newest(), results.asked()), (None, Some(&10), Some(&2)));
        let (second, _) = given.recv().unwrap();
        assert!(finished.send(second, Some(20)));
        results.take();
        results.take();
        assert_eq!((results.current(), results.progress()), (Some(&20), None));
        results.ask(3);
        results.cancel();
        results.ask(3);
        let (third, _) = given.recv().unwrap();
        assert!(finished.send(third, Some(30)));
        results.take();
        assert_eq!((results.current(), results.newest()), (None, Some(&20)));
        assert!(given.try_recv().is_err(), "a cancelled job is not requested again by itself");
        results.forget();
        results.ask(3);
        assert_eq!((results.newest(), given.recv().unwrap().1), (None, 3));
    }
}
