//! The state the device starts in, from how the last run ended.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use heapless::String;
use slipline_protocol::board::OrderedFault;
use slipline_protocol::event::{Fault, ResetCause};
use slipline_protocol::limits::MAX_CRASH;

use crate::safety::crash::CrashRecord;
use crate::safety::thermal::Heat;

/// Abnormal resets in a row after which the device answers but does not drive (safe mode).
pub const SAFE_MODE_RESETS: u8 = 3;
/// Run time in milliseconds after which earlier abnormal resets do not count any more. Then the shell writes
/// [`CrashRecord::stable`] back.
pub const STABLE_AFTER_MS: u32 = 60_000;

/// How the device starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Boot {
    /// Why it was reset.
    pub reset: ResetCause,
    /// What the last panic said, or nothing.
    pub crash: String<MAX_CRASH>,
    /// Safe mode: answer, but do not drive.
    pub safe_mode: bool,
    /// How hot the coil may be.
    pub heat: Heat,
    /// The ordered fault that ended the last run.
    pub ordered: Option<OrderedFault>,
}

impl Boot {
    /// A start after power came on, with a coil that is known to be cold.
    #[must_use]
    pub const fn cold() -> Self {
        Self {
            reset: ResetCause::PowerOn,
            crash: String::new(),
            safe_mode: false,
            heat: Heat::Cold,
            ordered: None,
        }
    }

    /// The fault that the reset itself is.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        match self.reset {
            ResetCause::PowerOn | ResetCause::Pin | ResetCause::Software => None,
            ResetCause::Watchdog => Some(Fault::Watchdog),
            ResetCause::BrownOut => Some(Fault::BrownOut),
            ResetCause::Panic | ResetCause::HardFault => Some(Fault::Crash),
        }
    }
}

/// Decides the boot state from the hardware's reset cause and the kept record, and returns the record to keep from now
/// on. Write that back before anything that could crash.
///
/// The handlers end with a software reset, so a record of a panic or a hard fault overrules that cause. Power-on
/// clears the record, the reset pin clears the count: a person has acted. A fault that was ordered does not count, if the reset is the one
/// that it leads to.
#[must_use]
pub fn decide(hardware: ResetCause, kept: Option<CrashRecord>) -> (Boot, CrashRecord) {
    let kept = kept.unwrap_or_default();
    let crashed = matches!(kept.cause, ResetCause::Panic | ResetCause::HardFault);
    let (reset, message) = match hardware {
        ResetCause::Software if crashed => (kept.cause, kept.message),
        ResetCause::Panic | ResetCause::HardFault => (hardware, kept.message),
        other => (other, String::new()),
    };
    let ordered = kept.ordered.filter(|&fault| reset == reset_by(fault));
    let resets = match reset {
        _ if ordered.is_some() => kept.resets,
        ResetCause::PowerOn | ResetCause::Pin => 0,
        // A dip of the supply is not the program's fault.
        ResetCause::Software | ResetCause::BrownOut => kept.resets,
        ResetCause::Watchdog | ResetCause::Panic | ResetCause::HardFault => kept.resets.saturating_add(1),
    };
    let safe_mode = resets >= SAFE_MODE_RESETS;
    let boot = Boot { reset, crash: message, safe_mode, heat: Heat::AssumedHot, ordered };
    // The cause has been reported: only a new crash writes one again.
    (boot, CrashRecord { resets, ..CrashRecord::default() })
}

/// The reset that an ordered fault leads to.
#[must_use]
pub const fn reset_by(fault: OrderedFault) -> ResetCause {
    match fault {
        OrderedFault::Hang | OrderedFault::MaskedInterrupts => ResetCause::Watchdog,
        OrderedFault::StackOverflow => ResetCause::HardFault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crash(resets: u8) -> CrashRecord {
        CrashRecord::crashed(ResetCause::Panic, resets, &"index out of bounds")
    }

    #[test]
    fn a_panic_is_reported_once_and_counted() {
        let (boot, kept) = decide(ResetCause::Software, Some(crash(0)));
        assert_eq!(
            (boot.reset, boot.crash.as_str(), boot.safe_mode),
            (ResetCause::Panic, "index out of bounds", false)
        );
        assert_eq!(boot.fault(), Some(Fault::Crash));
        assert_eq!(kept.resets, 1);
        let (boot, kept) = decide(ResetCause::Software, Some(kept));
        assert_eq!((boot.reset, boot.crash.as_str(), kept.resets), (ResetCause::Software, "", 1));
    }

    #[test]
    fn the_third_abnormal_reset_in_a_row_is_safe_mode() {
        let mut kept = CrashRecord::default();
        for n in 1..=5 {
            let (boot, next) = decide(ResetCause::Watchdog, Some(kept));
            assert_eq!(boot.safe_mode, n >= 3, "reset {n}");
            kept = next;
        }
        assert!(!decide(ResetCause::Watchdog, Some(kept.clone().stable())).0.safe_mode);
        assert!(!decide(ResetCause::Pin, Some(kept)).0.safe_mode);
    }

    #[test]
    fn ordered_faults_are_reported_and_do_not_count_and_every_other_reset_does() {
        let mut kept = CrashRecord { resets: 1, ..CrashRecord::default() };
        for fault in [OrderedFault::Hang, OrderedFault::MaskedInterrupts, OrderedFault::StackOverflow] {
            let (hardware, cause) = match reset_by(fault) {
                ResetCause::Watchdog => (ResetCause::Watchdog, ResetCause::PowerOn),
                crashed => (ResetCause::Software, crashed),
            };
            let ordered = CrashRecord { cause, ordered: Some(fault), ..kept.clone() };
            // Another reset than that of the order came first.
            let (boot, next) = decide(ResetCause::BrownOut, Some(ordered.clone()));
            assert_eq!((boot.ordered, next.ordered), (None, None));
            let panicked = CrashRecord { cause: ResetCause::Panic, ..ordered.clone() };
            let (boot, next) = decide(ResetCause::Software, Some(panicked));
            assert_eq!((boot.ordered, boot.reset, next.resets), (None, ResetCause::Panic, 2));
            let (boot, next) = decide(hardware, Some(ordered));
            assert_eq!((boot.ordered, boot.reset, next.resets), (Some(fault), reset_by(fault), 1));
            assert!(boot.fault().is_some() && !boot.safe_mode && next.ordered.is_none());
            kept = next;
        }
        let (boot, kept) = decide(ResetCause::Watchdog, Some(kept));
        assert_eq!((boot.ordered, kept.resets), (None, 2), "one that nobody has ordered counts");
    }

    #[test]
    fn the_count_of_resets_never_wraps() {
        let (boot, kept) = decide(ResetCause::Software, Some(crash(u8::MAX)));
        assert!(boot.safe_mode && kept.resets == u8::MAX);
    }

    #[test]
    fn after_every_reset_the_coil_may_be_hot() {
        // or a reset would be a way around the thermal model.
        use ResetCause::{BrownOut, HardFault, Panic, Pin, PowerOn, Software, Watchdog};
        for cause in [PowerOn, Pin, Software, Watchdog, BrownOut, Panic, HardFault] {
            for kept in [None, Some(crash(0)), Some(CrashRecord::default())] {
                assert_eq!(decide(cause, kept).0.heat, Heat::AssumedHot, "{cause:?}");
            }
        }
    }

    #[test]
    fn memory_without_a_record_after_power_on_is_a_clean_start() {
        let (boot, kept) = decide(ResetCause::PowerOn, None);
        assert_eq!(
            (boot.reset, boot.safe_mode, boot.fault(), kept.resets),
            (ResetCause::PowerOn, false, None, 0)
        );
        assert_eq!(boot.heat, Heat::AssumedHot);
    }
}
