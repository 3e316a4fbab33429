//! What a person does about a latched fault before it is cleared.

use slipline_protocol::event::Fault;

/// What to do about a fault before it is cleared, as the beginning of a sentence without a capital.
///
/// ```
/// use slipline_link::protocol::event::Fault;
///
/// assert_eq!(slipline_link::remedy(Fault::Overheat), "let the actuator cool, and drive it at a lower level");
/// ```
#[must_use]
pub const fn remedy(fault: Fault) -> &'static str {
    match fault {
        Fault::HostLost => "see why the program was held up or its line was cut",
        Fault::EmergencyStop => "make sure that nothing is in danger at the plate",
        Fault::Underrun => "drive fewer tones, or measure fewer at once, if it comes again",
        Fault::Overheat => "let the actuator cool, and drive it at a lower level",
        Fault::DriveTime => "see that nobody has left the device alone",
        Fault::Watchdog | Fault::Crash => "report it with the text of `slipline info`",
        Fault::BrownOut => "check the supply and its cable",
        Fault::StoreDamaged => "keep a table, or write the actuator's profile, again",
        Fault::StoreFellBack => "keep the table again",
        Fault::DeskStop => "release the button at the device, or close its stop input, and wait for 2 s",
        Fault::ProfileFellBack => "hold the board's user button meanwhile, or write the profile again",
    }
}
