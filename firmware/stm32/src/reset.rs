//! The cause of the last reset, from the chip's reset flags.

use slipline_app::ResetCause;

/// A chip's reset flags. Several are set at once: every reset also sets the pin's flag, and a power-on the brown-out's.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ResetFlags {
    pub(crate) watchdog: bool,
    pub(crate) software: bool,
    pub(crate) power_on: bool,
    pub(crate) brown_out: bool,
    pub(crate) pin: bool,
}

impl ResetFlags {
    /// The cause. A flag that fewer causes set is looked at first; with no flag set the power has just come on.
    pub(crate) const fn cause(self) -> ResetCause {
        if self.watchdog {
            ResetCause::Watchdog
        } else if self.software {
            ResetCause::Software
        } else if self.power_on {
            ResetCause::PowerOn
        } else if self.brown_out {
            ResetCause::BrownOut
        } else if self.pin {
            ResetCause::Pin
        } else {
            ResetCause::PowerOn
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_reset_sets_besides_its_own_flag_does_not_hide_it() {
        let pin = ResetFlags { pin: true, ..ResetFlags::default() };
        let brown_out = ResetFlags { brown_out: true, ..pin };
        for (flags, cause) in [
            (ResetFlags::default(), ResetCause::PowerOn),
            (pin, ResetCause::Pin),
            (brown_out, ResetCause::BrownOut),
            (ResetFlags { power_on: true, ..brown_out }, ResetCause::PowerOn),
            (ResetFlags { software: true, ..pin }, ResetCause::Software),
            (ResetFlags { watchdog: true, ..pin }, ResetCause::Watchdog),
        ] {
            assert_eq!(flags.cause(), cause, "{flags:?}");
        }
    }
}
