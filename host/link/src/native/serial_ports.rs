//! The serial ports of this computer, and which of them are Slipline devices.

use crate::port::{Port, PortInfo, USB_PRODUCT, USB_VENDOR};
use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};
use std::path::Path;

/// Other projects use the same USB ids, so the product's name must begin with this text, too.
const USB_PRODUCT_NAME: &str = "Slipline";

/// Every port that exists now: the simulated device if this program has it, then Slipline devices, then the other serial ports by name.
///
/// macOS has two names for each port. Only the `cu.` one is listed: opening the `tty.` one waits for a
/// carrier, which is never signalled. Ports that cannot be listed (no permission) are omitted; they can still
/// be named.
#[must_use]
pub fn list_ports() -> Vec<PortInfo> {
    let mut serial: Vec<PortInfo> = listed_by_system()
        .into_iter()
        .filter(|port| !(cfg!(target_os = "macos") && port.port_name.starts_with("/dev/tty.")))
        .map(|port| describe(port.port_name, &port.port_type))
        .collect();
    serial.sort_by(|a, b| b.is_ours.cmp(&a.is_ours).then_with(|| a.label.cmp(&b.label)));
    let simulated = cfg!(feature = "simulator").then(PortInfo::simulated);
    simulated.into_iter().chain(serial).collect()
}

/// What the system lists. A container may have no `/sys`, without which the library panics.
fn listed_by_system() -> Vec<SerialPortInfo> {
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Vec::new();
    }
    serialport::available_ports().unwrap_or_default()
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
    // Some systems do not report the product's name; then vendor and product id must suffice.
    let name_fits = usb.product.as_deref().is_none_or(|product| product.starts_with(USB_PRODUCT_NAME));
    usb.vid == USB_VENDOR && usb.pid == USB_PRODUCT && name_fits
}

#[cfg(test)]
mod tests {
    use super::*;

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
