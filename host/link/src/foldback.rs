//! Steps of the thermal fold-back between two statuses.
//!
//! The fold-back changes only at the beginning of a period. A status holds its value in the present period
//! and in the periods before it, and the number of changes since the reset. So a host that missed statuses in
//! between still knows every step, or detects that one is missing.

use slipline_protocol::event::Status;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::SampleIndex;

/// The steps of the fold-back that a status reports and the previous status did not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoldbackSteps {
    /// The index where each step begins, and the factor of all amplitudes from there on, per mille; in order.
    pub steps: Vec<(SampleIndex, u16)>,
    /// Whether the list is complete. If not, the codes between the two statuses are not known.
    pub is_complete: bool,
}

impl FoldbackSteps {
    /// The steps from `before` to `status`; without an earlier status, the fold-back in force.
    #[must_use]
    pub fn between(before: Option<&Status>, status: &Status, timing: &Timing) -> Self {
        let since = timing.limit_since(status.now);
        let present = (since, status.foldback_per_mille);
        let Some(before) = before.filter(|before| before.now <= status.now) else {
            return Self { steps: vec![present], is_complete: true };
        };
        let periods = (since - timing.limit_since(before.now)) / timing.limit_period;
        let reported = status.foldback_before_per_mille.len() as u64 + 1;
        // The oldest first.
        let values = status.foldback_before_per_mille.into_iter().rev().chain([status.foldback_per_mille]);
        let begins = |age: u64| since - age * timing.limit_period;
        let reported_periods = (0..reported).rev().zip(values).filter(|(age, _)| *age < periods);

        let mut last = before.foldback_per_mille;
        let mut steps = Vec::new();
        for (age, per_mille) in reported_periods {
            if per_mille != last {
                steps.push((begins(age), per_mille));
                last = per_mille;
            }
        }
        let count = u32::try_from(steps.len()).unwrap_or(u32::MAX);
        let is_complete = status.foldback_changes.wrapping_sub(before.foldback_changes) == count
            && last == status.foldback_per_mille
            && (periods <= reported || steps.first().is_none_or(|(at, _)| *at > begins(reported - 1)));
        if !is_complete && steps.is_empty() {
            steps.push(present);
        }
        Self { steps, is_complete }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 400_000;

    /// The status in the middle of a period, after these values of the fold-back, one per period from 0 on.
    fn status(values: &[u16]) -> Status {
        let last = values.len() - 1;
        let of = |age: usize| values[last.saturating_sub(age)];
        Status {
            now: Timing::at(RATE_HZ).limit_period * last as u64 + 64_000,
            foldback_per_mille: of(0),
            foldback_before_per_mille: [of(1), of(2), of(3)],
            foldback_changes: values.windows(2).filter(|pair| pair[0] != pair[1]).count() as u32,
            ..Status::default()
        }
    }

    /// The steps that a host derives, in periods, if it receives the status after `first` and the one after
    /// all values, and none in between.
    fn heard(values: &[u16], first: usize) -> (Vec<(u64, u16)>, bool) {
        let timing = Timing::at(RATE_HZ);
        let heard = FoldbackSteps::between(Some(&status(&values[..first])), &status(values), &timing);
        let steps = heard.steps.into_iter().map(|(at, per_mille)| {
            assert_eq!(at % timing.limit_period, 0);
            (at / timing.limit_period, per_mille)
        });
        (steps.collect(), heard.is_complete)
    }

    #[test]
    fn missed_periods_are_read_from_the_next_status() {
        assert_eq!(heard(&[1000, 1000], 2), (vec![], true), "the same period");
        assert_eq!(heard(&[1000, 990], 1), (vec![(1, 990)], true), "none missed");
        assert_eq!(heard(&[1000, 990, 980], 1), (vec![(1, 990), (2, 980)], true), "one missed");
        assert_eq!(heard(&[1000, 990, 1000], 1), (vec![(1, 990), (2, 1000)], true), "there and back");
        let four = [1000, 990, 990, 970, 960];
        assert_eq!(heard(&four, 1), (vec![(1, 990), (3, 970), (4, 960)], true), "as many as are reported");
    }

    #[test]
    fn a_gap_longer_than_the_report_is_known_to_be_incomplete() {
        assert!(!heard(&[1000, 990, 980, 970, 960, 950], 1).1, "a step before those reported");
        assert!(
            !heard(&[1000, 990, 1000, 1000, 1000, 1000, 1000], 1).1,
            "there and back before those reported"
        );
        assert!(!heard(&[1000, 1000, 990, 990, 990, 990, 990], 1).1, "one step, at an unreported period");
        assert!(!heard(&[1000, 1000, 990, 990, 990, 990], 1).1, "the oldest reported may have begun earlier");
    }

    #[test]
    fn a_long_gap_without_a_change_is_no_loss() {
        assert_eq!(heard(&[1000; 40], 1), (vec![], true));
        let late = [1000, 1000, 1000, 1000, 1000, 1000, 980, 970];
        assert_eq!(heard(&late, 1), (vec![(6, 980), (7, 970)], true), "all changes are among those reported");
    }

    #[test]
    fn the_first_status_reports_what_is_in_force() {
        let first = FoldbackSteps::between(None, &status(&[1000, 870]), &Timing::at(RATE_HZ));
        assert_eq!(first, FoldbackSteps { steps: vec![(128_000, 870)], is_complete: true });
    }
}
