//! What a device has found on its board: the body of [`Event::Board`](crate::Event::Board).

use crate::schema::{body, choices};

choices! {
    /// The resistor that holds the mute pin low while the chip does not drive it.
    #[derive(Default)]
    pub enum MuteResistor {
        /// There is no such pin, or the device does not look.
        #[default]
        0 since 0 NotLooked,
        /// It was present at the start.
        1 since 0 Present,
        /// It was absent at the start: the amplifier stays muted until a reset finds it.
        2 since 0 Missing,
    }
}

choices! {
    /// The board's user button. Pressed while the device is armed it is an emergency stop.
    #[derive(Default)]
    pub enum UserButton {
        /// There is none.
        #[default]
        0 since 0 None,
        /// It is not pressed.
        1 since 0 Released,
        /// It is pressed.
        2 since 0 Pressed,
    }
}

choices! {
    /// The stop input: a contact to ground that is closed while the amplifier may be on. Opened, or with a cut wire, it mutes in hardware.
    #[derive(Default)]
    pub enum StopInput {
        /// There is none, or no profile says whether one is fitted.
        #[default]
        0 since 0 Unused,
        /// It is closed.
        1 since 0 Closed,
        /// It is open: the amplifier is off, and the device cannot be armed.
        2 since 0 Open,
        /// Something is wired to its pin, although the profile says that none is fitted.
        3 since 0 NotInProfile,
    }
}

body! {
    /// The body of [`Event::Board`](crate::Event::Board).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct BoardReport {
        /// The clock in which `max_cycles` of the status counts; 0 where the device has no cycle counter.
        pub core_hz: u32 ["Hz"],
        /// Whether the mute pin has its resistor.
        pub mute_resistor: MuteResistor [""],
        /// The user button at this moment.
        pub user_button: UserButton [""],
        /// The stop input at this moment.
        pub stop_input: StopInput [""],
        /// There is a trigger input: drives may wait for it.
        pub trigger_input: bool [""],
    }
}
