//! The time that a procedure still takes, by its plan and by its course so far.

/// The share of a procedure from which on its course corrects its plan.
const KNOWN: f64 = 0.03;

/// Samples that a procedure still takes whose plan has `planned` samples, when it has done this share of them (0 to 1) in
/// `elapsed` samples. The link's delays and longer windows are in no plan: a procedure that was slower than planned so far is
/// taken to stay as slow.
#[must_use]
pub(crate) fn remaining_samples(planned: f64, done: f64, elapsed: f64) -> f64 {
    let slowness = if done > KNOWN { (elapsed / (done * planned)).max(1.0) } else { 1.0 };
    (1.0 - done).max(0.0) * planned * slowness
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_counts_down_and_a_slow_course_stretches_it() {
        let left = |done: f64, elapsed: f64| remaining_samples(1000.0, done, elapsed);
        assert_eq!([left(0.0, 0.0), left(0.5, 500.0), left(1.0, 1000.0)], [1000.0, 500.0, 0.0]);
        // Four windows a comb instead of one.
        assert_eq!([left(0.25, 1000.0), left(0.5, 2000.0)], [3000.0, 2000.0]);
        // Before anything is known of its course, and where it is quicker than planned, the plan counts.
        assert_eq!([left(0.01, 900.0), left(0.5, 400.0)], [990.0, 500.0]);
    }
}
