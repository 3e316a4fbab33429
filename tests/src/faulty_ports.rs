//! Ports for the host's link with a simulated device behind them, and the faults that a test injects between the two:
//! lost replies and commands, changed replies, failing reads and writes, a pulled cable.

use std::io::{self, ErrorKind};
use std::sync::{Arc, Mutex, MutexGuard};

use slipline_link::native::Watch;
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Opener, Transport, Waker, read_received};
use slipline_link::{LinkError, Port, PortInfo};
use slipline_protocol::event::Identity;
use slipline_protocol::version::Minor;
use slipline_protocol::{Command, Decoder, Event, Header};

/// Changes a reply on its way.
pub type Rewrite = fn(Event) -> Event;

/// The ports that the system lists, the one device behind them, and the faults to inject.
pub struct FaultyPorts {
    /// The device.
    pub device: SimulatedDevice,
    /// The ports that the system lists.
    pub listed: Vec<PortInfo>,
    /// The error of every read and write; `None` lets them work. A line that was opened before the last
    /// [`FaultyPorts::unplug`] fails in any case.
    pub error: Option<ErrorKind>,
    /// The device stands still: no time passes for it, and what is sent to it waits.
    pub is_stalled: bool,
    /// How often the cable was pulled.
    pub generation: u32,
    /// Why a port cannot be opened.
    pub open_error: Option<LinkError>,
    /// Ports that are opened stay shut until this is false, as in a browser; [`FaultyPorts::error`] is why they fail.
    pub is_opening: bool,
    /// Number of the next replies to drop.
    pub drop_replies: u32,
    /// Number of the next numbered commands to drop.
    pub drop_commands: u32,
    /// Number of the next stops to drop.
    pub drop_stops: u32,
    /// Changes a reply on its way.
    pub rewrite: Rewrite,
    /// Bytes that come to the host besides what the device says.
    pub injected: Vec<u8>,
    /// Decodes the host's bytes.
    pub from_host: Decoder,
    /// Decodes the device's bytes.
    pub from_device: Decoder,
    /// Every command that the host has sent, with its sequence number; a dropped one, too.
    pub commands: Vec<(u16, Command)>,
    /// The header of the last of them.
    pub last: Option<Header>,
    /// The ports in the order in which they were opened.
    pub opened: Vec<Port>,
    /// How often a line was read.
    pub reads: u64,
}

impl Default for FaultyPorts {
    /// One board on port A, no faults.
    fn default() -> Self {
        Self {
            device: SimulatedDevice::new(Options::default()),
            listed: vec![board("A")],
            error: None,
            is_stalled: false,
            generation: 0,
            open_error: None,
            is_opening: false,
            drop_replies: 0,
            drop_commands: 0,
            drop_stops: 0,
            rewrite: as_real,
            injected: Vec::new(),
            from_host: Decoder::new(),
            from_device: Decoder::new(),
            commands: Vec::new(),
            last: None,
            opened: Vec::new(),
            reads: 0,
        }
    }
}

impl FaultyPorts {
    /// Stops the whole device, as a debugger would, or lets it go on.
    pub fn stall(&mut self, is_stalled: bool) {
        self.is_stalled = is_stalled;
        self.device.freeze_link(is_stalled);
    }

    /// Pulls the cable: every open line is gone, and no port is listed.
    pub fn unplug(&mut self) {
        self.generation += 1;
        self.listed.clear();
    }
}

/// The simulated device, claiming to be a real one: it must not be armed unasked.
#[must_use]
pub fn as_real(event: Event) -> Event {
    identified(event, |_| ())
}

/// The same, with a change of the identity that it states.
pub fn identified(event: Event, change: impl FnOnce(&mut Identity)) -> Event {
    match event {
        Event::Hello(mut identity) => {
            identity.simulated = false;
            change(&mut identity);
            Event::Hello(identity)
        }
        event => event,
    }
}

/// The entry of a board under this port name; the USB serial number is always the same.
#[must_use]
pub fn board(name: &str) -> PortInfo {
    PortInfo {
        port: Port::Serial(name.to_owned()),
        label: "Slipline".to_owned(),
        is_ours: true,
        usb_serial: Some("0001".to_owned()),
    }
}

/// The ports as the test and the link share them.
pub type SharedPorts = Arc<Mutex<FaultyPorts>>;

/// Locks the ports, even after a panic in another thread.
pub fn lock(ports: &SharedPorts) -> MutexGuard<'_, FaultyPorts> {
    ports.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Opens the ports for the link.
pub struct PortsOpener(pub SharedPorts);

impl Opener for PortsOpener {
    type Transport = Line;

    fn list(&mut self) -> Vec<PortInfo> {
        lock(&self.0).listed.clone()
    }

    fn open(&mut self, port: &Port, _waker: &Waker) -> Result<Line, LinkError> {
        let mut ports = lock(&self.0);
        ports.opened.push(port.clone());
        if let Some(trouble) = &ports.open_error {
            return Err(trouble.clone());
        }
        if !ports.listed.iter().any(|info| info.port == *port) {
            return Err(LinkError::NoSuchPort(port.clone()));
        }
        Ok(Line { ports: self.0.clone(), generation: ports.generation, received: Vec::new() })
    }
}

/// An open port.
pub struct Line {
    ports: SharedPorts,
    generation: u32,
    received: Vec<u8>,
}

impl Line {
    fn trouble(&self, ports: &FaultyPorts) -> io::Result<()> {
        match ports.error {
            Some(kind) => Err(kind.into()),
            None if self.generation != ports.generation => Err(ErrorKind::BrokenPipe.into()),
            None => Ok(()),
        }
    }
}

impl Watch for Line {}

impl Transport for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut ports = lock(&self.ports);
        ports.reads += 1;
        match self.trouble(&ports) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(0),
            result => result?,
        }
        if ports.is_opening {
            return Err(ErrorKind::WouldBlock.into());
        }
        let mut bytes = Vec::new();
        ports.device.take(&mut bytes);
        for byte in bytes {
            let FaultyPorts { from_device, rewrite, drop_replies, .. } = &mut *ports;
            let reply = from_device.push(byte, |frame| {
                let event =
                    Event::decode(frame.header.id, frame.body).expect("the device speaks its own protocol");
                rewrite(event)
                    .frame_for(Minor::OURS, frame.header.session, frame.header.sequence)
                    .expect("fits")
            });
            match reply {
                Some(_) if *drop_replies > 0 => *drop_replies -= 1,
                Some(frame) => self.received.extend_from_slice(&frame),
                None => {}
            }
        }
        self.received.append(&mut ports.injected);
        read_received(&mut self.received, buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut ports = lock(&self.ports);
        self.trouble(&ports)?;
        for &byte in bytes {
            let found = ports.from_host.push(byte, |frame| {
                (
                    frame.header,
                    Command::decode(frame.header.id, frame.body).expect("the host speaks the protocol"),
                )
            });
            let Some((header, command)) = found else { continue };
            ports.commands.push((header.sequence, command.clone()));
            ports.last = Some(header);
            if ports.drop_commands > 0 && command.is_sequenced() {
                ports.drop_commands -= 1;
                continue;
            }
            if ports.drop_stops > 0 && matches!(command, Command::Stop | Command::EmergencyStop) {
                ports.drop_stops -= 1;
                continue;
            }
            let frame = command.frame_for(Minor::OURS, header.session, header.sequence).expect("fits");
            ports.device.feed(&frame);
        }
        Ok(bytes.len())
    }

    fn is_open(&self) -> bool {
        !lock(&self.ports).is_opening
    }
}
