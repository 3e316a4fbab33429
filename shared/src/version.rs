//! Versions: what two sides of different ages may say to each other.
//!
//! ```text
//! host 1.1 --Hello(1.1)--> device 1.0      both speak 1.0: the lower of the two minors
//! host 1.0 --Hello(1.0)--> device 1.1      both speak 1.0
//! host 1.x --Hello(1.x)--> device 2.y      identify, stop, bootloader
//! ```
//! Within a major version nothing that exists changes: a minor adds messages, and variants at the end of enumerations.
//! The layout of `Hello` and the first six bytes of its answer are frozen for all versions, so that each side can learn
//! what the other speaks. From then on neither sends a message or a variant that is newer than the lower of the two
//! minors: the one way to bytes, [`Command::frame_for`](crate::Command::frame_for) and
//! [`Event::frame_for`](crate::Event::frame_for), takes that [`Minor`].

pub use crate::minor::{MINOR, Minor};
use crate::schema::body;

/// Rises when a message changes its meaning or its bytes. Hosts and devices of different majors do not drive.
pub const MAJOR: u8 = 1;

/// The fingerprint of this major version: the CRC-32 of all frames in `wire/v1.snap`, one after the other. They are the
/// frozen frames of minor 0, so it is the same for every minor. Development builds of before the first release have
/// other fingerprints, so a release does not drive them.
pub const SCHEMA: u32 = 0x077e_45e7;

body! {
    /// What one side speaks.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Version {
        /// The major version.
        pub major: u8 [""],
        /// The minor version.
        pub minor: u8 [""],
        /// The fingerprint of the major version, little-endian.
        pub schema: [u8; 4] [""],
    }
}

impl Version {
    /// The version that this build speaks.
    pub const OURS: Self = Self { major: MAJOR, minor: MINOR, schema: SCHEMA.to_le_bytes() };

    /// What a host of this version should do about a device of that version.
    #[must_use]
    pub fn judge_device(self, device: Self) -> Compatibility {
        if device.major > self.major {
            Compatibility::UpdateHost
        } else if !self.may_drive(device) {
            Compatibility::FlashDevice
        } else if device.minor > self.minor {
            Compatibility::DeviceNewer
        } else if device.minor < self.minor {
            Compatibility::DeviceOlder
        } else {
            Compatibility::Same
        }
    }

    /// The minor version that the two sides speak: the lower of theirs; [`Minor::FIRST`] if they may not drive.
    #[must_use]
    pub fn shared_minor(self, other: Self) -> Minor {
        if self.may_drive(other) { Minor::new(self.minor.min(other.minor)) } else { Minor::FIRST }
    }

    /// Whether commands that drive the plate may pass between the two.
    #[must_use]
    pub fn may_drive(self, other: Self) -> bool {
        self.major == other.major && self.schema == other.schema
    }
}

/// What a host should do about a device's version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Compatibility {
    /// Everything works.
    Same,
    /// Everything this host knows works; the device can do more.
    DeviceNewer,
    /// Everything the device knows works; this host can do more and does not offer it.
    DeviceOlder,
    /// The device's firmware is of an older major version, or of another development build: identify, stop and the
    /// bootloader only.
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
            Self::DeviceOlder => {
                "The device's firmware is older than this program; what it cannot do yet is not offered."
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
        matches!(self, Self::Same | Self::DeviceNewer | Self::DeviceOlder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pair_of_versions_has_one_judgement() {
        let version = |major, minor| Version { major, minor, ..Version::OURS };
        let judge = |host, device| version(1, host).judge_device(device);
        assert_eq!(judge(3, version(1, 3)), Compatibility::Same);
        assert_eq!(judge(3, version(1, 4)), Compatibility::DeviceNewer);
        assert_eq!(judge(3, version(1, 2)), Compatibility::DeviceOlder);
        assert_eq!(judge(3, version(2, 0)), Compatibility::UpdateHost);
        assert_eq!(judge(3, version(0, 9)), Compatibility::FlashDevice);
        let other_build = Version { schema: [0; 4], ..version(1, 3) };
        assert_eq!(judge(3, other_build), Compatibility::FlashDevice);
        assert_eq!(Version::OURS.shared_minor(other_build), Minor::FIRST);
        assert_eq!(Version::OURS.shared_minor(version(1, 200)), Minor::OURS);
    }
}
