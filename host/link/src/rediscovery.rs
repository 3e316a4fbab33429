//! Rediscovery: recognition of a lost device when it returns.

use crate::port::{Port, PortInfo};

/// Identity of the sought device, and the ports of other devices.
#[derive(Debug)]
pub(super) struct Rediscovery {
    /// The port of the lost device.
    info: PortInfo,
    /// The chip's unique id, once the device has reported it.
    unit: Option<[u8; 12]>,
    /// Listed ports at which another device answered.
    others: Vec<Port>,
}

impl Rediscovery {
    /// The device that will answer at a port.
    pub(super) const fn at(info: PortInfo) -> Self {
        Self { info, unit: None, others: Vec::new() }
    }

    /// Whether the device that answers at `port` is the sought one, by its chip; the first device that
    /// answers is.
    pub(super) fn is_it(&mut self, unit: [u8; 12], port: Option<&Port>) -> bool {
        let is_it = *self.unit.get_or_insert(unit) == unit;
        if !is_it {
            self.others.extend(port.cloned());
        }
        is_it
    }

    /// The port to try next: by the USB serial number or, if the device has none, by the port's name and then
    /// among ports of its kind.
    pub(super) fn find(&mut self, mut ports: Vec<PortInfo>) -> Option<Port> {
        // A port that has disappeared from the list may return with the sought device.
        self.others.retain(|other| ports.iter().any(|info| info.port == *other));
        ports.retain(|info| !self.others.contains(&info.port));
        let own = &self.info;
        let found = if own.usb_serial.is_some() {
            ports.iter().find(|info| info.usb_serial == own.usb_serial).map(|info| info.port.clone())
        } else {
            let is_kin = |info: &&PortInfo| {
                own.is_ours && info.is_ours && ![&own.port, &info.port].contains(&&Port::Simulated)
            };
            let known = ports.iter().find(|info| info.port == own.port).or_else(|| ports.iter().find(is_kin));
            // Sockets and pseudo-terminals are not listed: try the name.
            Some(known.map_or_else(|| own.port.clone(), |info| info.port.clone()))
        };
        found.filter(|port| !self.others.contains(port))
    }
}
