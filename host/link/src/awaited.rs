//! The requests whose outcomes callers wait for. The snapshot keeps these outcomes until their callers have them, however many
//! requests of other threads end meanwhile.

use crate::request::{Outcome, Ticket};
use std::collections::{BTreeSet, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of outcomes that are kept although no caller is known to wait for them.
pub(crate) const OUTCOMES: usize = 64;

/// The awaited requests; clones share them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Awaited(Arc<Mutex<BTreeSet<Ticket>>>);

impl Awaited {
    /// Keeps the outcome of this request from now on.
    #[cfg(any(feature = "native", test))]
    pub(crate) fn keep(&self, ticket: Ticket) {
        self.tickets().insert(ticket);
    }

    /// Its caller has the outcome, or waits no longer.
    #[cfg(any(feature = "native", test))]
    pub(crate) fn release(&self, ticket: Ticket) {
        self.tickets().remove(&ticket);
    }

    /// Drops the oldest outcomes that no caller waits for, down to [`OUTCOMES`].
    pub(crate) fn trim(&self, outcomes: &mut VecDeque<(Ticket, Outcome)>) {
        if outcomes.len() <= OUTCOMES {
            return;
        }
        let mut excess = outcomes.len() - OUTCOMES;
        let awaited = self.tickets();
        outcomes.retain(|(ticket, _)| {
            let is_kept = excess == 0 || awaited.contains(ticket);
            excess -= usize::from(!is_kept);
            is_kept
        });
    }

    fn tickets(&self) -> MutexGuard<'_, BTreeSet<Ticket>> {
        // The set is complete at any time.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_awaited_outcome_outlives_any_number_of_others_until_it_is_released() {
        let (awaited, mut outcomes) = (Awaited::default(), VecDeque::new());
        let mut end = |awaited: &Awaited, number| {
            outcomes.push_back((Ticket(number), Outcome::Done { at: number }));
            awaited.trim(&mut outcomes);
            (outcomes.len(), outcomes[0].0)
        };
        awaited.keep(Ticket(3));
        let last = (1..=1000).map(|number| end(&awaited, number)).last();
        assert_eq!(last, Some((OUTCOMES, Ticket(3))));
        awaited.release(Ticket(3));
        assert_eq!(end(&awaited, 1001), (OUTCOMES, Ticket(1001 - OUTCOMES as u64 + 1)));
    }
}
