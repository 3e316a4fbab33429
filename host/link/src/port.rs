//! Ports of devices.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// The USB vendor id of a Slipline device: pid.codes.
pub const USB_VENDOR: u16 = 0x1209;
/// The USB product id of a Slipline device: the one that pid.codes reserves for development.
pub const USB_PRODUCT: u16 = 0x0001;

/// A port at which a device can be connected.
///
/// As text: `sim`, `unix:PATH`, or the name of a serial port.
/// ```
/// use slipline_link::Port;
/// assert_eq!("sim".parse(), Ok(Port::Simulated));
/// assert_eq!("/dev/ttyACM0".parse(), Ok(Port::Serial("/dev/ttyACM0".to_owned())));
/// assert!("unix:".parse::<Port>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Port {
    /// The device application in this process, with a simulated plate.
    Simulated,
    /// A serial port by its system name, such as `/dev/ttyACM0` or `COM3`.
    Serial(String),
    /// A Unix domain socket, such as an emulator's serial line.
    Unix(PathBuf),
}

/// A text that is not a port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not a port: write sim, unix:PATH or the name of a serial port")]
pub struct PortNameError(String);

impl FromStr for Port {
    type Err = PortNameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        match text.strip_prefix("unix:") {
            Some(path) if !path.is_empty() => Ok(Self::Unix(path.into())),
            None if text.eq_ignore_ascii_case("sim") => Ok(Self::Simulated),
            None if !text.is_empty() && !text.contains('\0') => Ok(Self::Serial(text.to_owned())),
            _ => Err(PortNameError(text.to_owned())),
        }
    }
}

impl fmt::Display for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("sim"),
            Self::Serial(name) => f.write_str(name),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

/// A port that exists now.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct PortInfo {
    /// The port.
    pub port: Port,
    /// The name shown to the user.
    pub label: String,
    /// Whether its USB identity is that of a Slipline device (or it is the simulated one).
    pub is_ours: bool,
    /// The USB serial number, if any: it stays the same when the port's name changes.
    pub usb_serial: Option<String>,
}

impl PortInfo {
    /// The simulated device, which is always there.
    #[must_use]
    pub fn simulated() -> Self {
        Self { port: Port::Simulated, label: "Simulated plate".to_owned(), is_ours: true, usb_serial: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_reads_back_what_it_prints() {
        for text in ["sim", "unix:/run/slip line.sock", "/dev/ttyACM0", "COM3"] {
            assert_eq!(text.parse::<Port>().unwrap().to_string(), text);
        }
        assert_eq!(" SIM ".parse(), Ok(Port::Simulated));
        for text in ["", "  ", "unix:", "a\0b"] {
            assert!(text.parse::<Port>().is_err(), "{text:?}");
        }
    }
}
