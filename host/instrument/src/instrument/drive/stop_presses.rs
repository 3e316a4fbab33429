//! Presses of STOP, Esc and Space. One press stops, and disarms a real device; two within a second are an emergency stop.

/// The second press counts within this time after the first, in seconds.
const TWICE_S: f64 = 1.0;

/// Time of the last press of STOP.
#[derive(Default)]
pub(super) struct StopPresses {
    /// In seconds of the window's clock.
    last_s: Option<f64>,
}

impl StopPresses {
    /// Records a press; returns whether it is the second of two within [`TWICE_S`].
    pub(super) fn is_second(&mut self, now_s: f64) -> bool {
        let is_second = self.has_first(now_s);
        self.last_s = Some(now_s);
        is_second
    }

    /// Whether a press now would be the second of two.
    pub(super) fn has_first(&self, now_s: f64) -> bool {
        self.last_s.is_some_and(|last_s| now_s - last_s <= TWICE_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_press_counts_within_a_second_of_the_one_before() {
        let mut presses = StopPresses::default();
        let times_s = [5.0, 6.1, 7.1, 7.2, 9.0];
        assert_eq!(times_s.map(|now_s| presses.is_second(now_s)), [false, false, true, true, false]);
    }
}
