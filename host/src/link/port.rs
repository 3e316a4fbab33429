//! Where a device can be found.

use serialport::{SerialPortType, UsbPortInfo};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// The USB vendor id of a Slipline device: pid.codes.
pub const USB_VENDOR: u16 = 0x1209;
/// The USB product id of a Slipline device: the pair that pid.codes gives away for development.
pub const USB_PRODUCT: u16 = 0x0001;
/// Others develop under the same pair, so the product's name must begin like this too.
pub const USB_PRODUCT_NAME: &str = "Slipline";

/// One place where a device can be.
///
/// As text: `sim`, `unix:PATH`, or the name of a serial port.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Port {
    /// The device application in this very process, with a simulated plate.
    Simulated,
    /// A serial port by its system name, such as `/dev/ttyACM0` or `COM3`.
    Serial(String),
    /// A Unix domain socket, such as an emulator's serial line.
    Unix(PathBuf),
}

/// A text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no port: write sim, unix:PATH or the name of a serial port")]
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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortInfo {
    /// The port.
    pub port: Port,
    /// What a person calls it.
    pub label: String,
    /// A Slipline device by its USB identity (or the simulated one).
    pub is_ours: bool,
    /// The USB serial number, where the port has one: it stays the same when the port's name changes.
    pub usb_serial: Option<String>,
}

impl PortInfo {
    /// The simulated device, which is always there.
    #[must_use]
    pub fn simulated() -> Self {
        Self { port: Port::Simulated, label: "Simulated plate".to_owned(), is_ours: true, usb_serial: None }
    }
}

/// Every port that exists now: the simulated device, then Slipline devices, then the other serial ports by name.
///
/// On macOS only the `cu.` half of each port is listed: the `tty.` half waits for a carrier that never comes. Ports
/// that cannot be listed (no permission) are left out; they can still be named.
#[must_use]
pub fn list_ports() -> Vec<PortInfo> {
    let mut serial: Vec<PortInfo> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        .filter(|port| !(cfg!(target_os = "macos") && port.port_name.starts_with("/dev/tty.")))
        .map(|port| describe(port.port_name, &port.port_type))
        .collect();
    serial.sort_by(|a, b| b.is_ours.cmp(&a.is_ours).then_with(|| a.label.cmp(&b.label)));
    std::iter::once(PortInfo::simulated()).chain(serial).collect()
}

fn describe(name: String, kind: &SerialPortType) -> PortInfo {
    let usb = if let SerialPortType::UsbPort(usb) = kind { Some(usb) } else { None };
    let label = match usb.and_then(|usb| usb.product.as_deref()) {
        Some(product) => format!("{} ({name})", product.replace('_', " ")),
        None => name.clone(),
    };
    PortInfo {
        port: Port::Serial(name),
        label,
        is_ours: usb.is_some_and(is_ours),
        usb_serial: usb.and_then(|usb| usb.serial_number.clone()),
    }
}

fn is_ours(usb: &UsbPortInfo) -> bool {
    // Some systems do not tell the product's name; then the pair has to do.
    let name_fits = usb.product.as_deref().is_none_or(|product| product.starts_with(USB_PRODUCT_NAME));
    usb.vid == USB_VENDOR && usb.pid == USB_PRODUCT && name_fits
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

    #[test]
    fn a_device_is_known_by_its_usb_pair_and_name() {
        let usb = |vid, pid, product: Option<&str>| {
            SerialPortType::UsbPort(UsbPortInfo {
                vid,
                pid,
                serial_number: Some("A1".to_owned()),
                manufacturer: None,
                product: product.map(str::to_owned),
            })
        };
        assert!(describe("p".into(), &usb(0x1209, 1, Some("Slipline F407"))).is_ours);
        assert!(describe("p".into(), &usb(0x1209, 1, None)).is_ours);
        assert!(!describe("p".into(), &usb(0x1209, 1, Some("Other thing"))).is_ours);
        assert!(!describe("p".into(), &usb(0x0483, 0x374b, Some("ST-Link"))).is_ours);
        assert_eq!(list_ports()[0], PortInfo::simulated());
    }
}
