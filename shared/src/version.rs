//! The version handshake.
//!
//! The layout of `Hello` and the first six bytes of its reply are frozen for ever: every host of every version can
//! ask every device what it speaks.

use serde::{Deserialize, Serialize};

/// Bumped when a message changes its meaning or its bytes. Hosts and devices of different majors do not drive.
pub const MAJOR: u8 = 1;
/// Bumped when messages are added.
pub const MINOR: u8 = 0;

/// The fingerprint of this major version: the CRC-32 of all frames in `wire/v1.snap`, one after the other. They are the
/// frozen frames of minor 0, so it is the same for every minor. It keeps development builds of before the first release
/// from taking each other for equals.
pub const SCHEMA: u32 = 0x5f60_5394;

/// What one side speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Version {
    /// Bumped on every incompatible change.
    pub major: u8,
    /// Bumped when messages are added.
    pub minor: u8,
    /// Fingerprint of the golden bytes, little-endian.
    pub schema: [u8; 4],
}

impl Version {
    /// What this build speaks.
    pub const OURS: Self = Self { major: MAJOR, minor: MINOR, schema: SCHEMA.to_le_bytes() };

    /// How the device's version stands to this build's.
    #[must_use]
    pub fn compare_device(self) -> Compatibility {
        if self.major < MAJOR || (self.major == MAJOR && self.schema != Self::OURS.schema) {
            Compatibility::FlashDevice
        } else if self.major > MAJOR {
            Compatibility::UpdateHost
        } else if self.minor > MINOR {
            Compatibility::DeviceNewer
        } else {
            Compatibility::Same
        }
    }

    /// Whether commands that drive the plate may pass between this build and `other`.
    #[must_use]
    pub fn may_drive(self, other: Self) -> bool {
        self.major == other.major && self.schema == other.schema
    }
}

/// What a host should do about a device's version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compatibility {
    /// Everything works.
    Same,
    /// Everything this host knows works; the device can do more.
    DeviceNewer,
    /// The device's firmware is older or differs: identify, stop and the bootloader only.
    FlashDevice,
    /// The device speaks a newer major version: identify, stop and the bootloader only.
    UpdateHost,
}

impl Compatibility {
    /// One plain sentence for the user.
    #[must_use]
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Same => "The device's firmware matches this program.",
            Self::DeviceNewer => {
                "The device's firmware is newer than this program; its new features are not shown."
            }
            Self::FlashDevice => {
                "The device's firmware does not match this program: flash the firmware that came with it. \
                 Until then only identify, stop and the bootloader work."
            }
            Self::UpdateHost => {
                "The device's firmware is newer than this program: install the newer Slipline. \
                 Until then only identify, stop and the bootloader work."
            }
        }
    }

    /// Whether the plate may be driven.
    #[must_use]
    pub const fn may_drive(self) -> bool {
        matches!(self, Self::Same | Self::DeviceNewer)
    }
}
