//! What lies behind the ports of a host's link, and how it behaves: a simulated device, and everything that can go wrong
//! between it and the host.

use std::io::{self, ErrorKind};
use std::sync::{Arc, Mutex, MutexGuard};

use slipline::link::simulated::{Options, SimulatedDevice};
use slipline::link::transport::{Opener, Transport, Waker, read_received};
use slipline::link::{Port, PortInfo, Trouble};
use slipline_protocol::{Command, Decoder, Event};

/// Changes a reply on its way.
pub type Rewrite = fn(Event) -> Event;

/// What lies behind the ports, and how it behaves.
pub struct World {
    /// The device.
    pub device: SimulatedDevice,
    /// The ports that exist.
    pub ports: Vec<PortInfo>,
    /// What every read and write says instead of what it would; lines opened before the last [`World::unplug`] are gone.
    pub error: Option<ErrorKind>,
    /// How often the cable was pulled.
    pub generation: u32,
    /// Why a port cannot be opened.
    pub open_error: Option<Trouble>,
    /// Drops this many replies.
    pub deaf_for: u32,
    /// Drops this many numbered commands.
    pub mute_for: u32,
    /// Drops this many stops.
    pub mute_stops_for: u32,
    /// Changes a reply on its way.
    pub rewrite: Rewrite,
    /// The host's bytes.
    pub from_host: Decoder,
    /// The device's bytes.
    pub from_device: Decoder,
    /// Sequence and kind of everything the host has sent.
    pub heard: Vec<(u16, Command)>,
    /// Ports in the order in which they were opened.
    pub opened: Vec<Port>,
    /// How often a line was read.
    pub reads: u64,
}

impl Default for World {
    /// One board, well and on port A.
    fn default() -> Self {
        Self {
            device: SimulatedDevice::new(Options::default()),
            ports: vec![board("A")],
            error: None,
            generation: 0,
            open_error: None,
            deaf_for: 0,
            mute_for: 0,
            mute_stops_for: 0,
            rewrite: as_real,
            from_host: Decoder::new(),
            from_device: Decoder::new(),
            heard: Vec::new(),
            opened: Vec::new(),
            reads: 0,
        }
    }
}

impl World {
    /// Pulls the cable: every open line is gone, and no port is listed.
    pub fn unplug(&mut self) {
        self.generation += 1;
        self.ports.clear();
    }
}

/// The simulated device, claiming to be a real one: it must not be armed unasked.
#[must_use]
pub fn as_real(event: Event) -> Event {
    match event {
        Event::Hello(mut identity) => {
            identity.simulated = false;
            Event::Hello(identity)
        }
        event => event,
    }
}

/// A board under this name, always the same one.
#[must_use]
pub fn board(name: &str) -> PortInfo {
    PortInfo {
        port: Port::Serial(name.to_owned()),
        label: "Slipline".to_owned(),
        is_ours: true,
        usb_serial: Some("0001".to_owned()),
    }
}

/// A world, from both sides of the line.
pub type Shared = Arc<Mutex<World>>;

/// Looks at a world, whatever has panicked meanwhile.
pub fn lock(world: &Shared) -> MutexGuard<'_, World> {
    world.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The ports of a world.
pub struct Ports(pub Shared);

impl Opener for Ports {
    fn list(&mut self) -> Vec<PortInfo> {
        lock(&self.0).ports.clone()
    }

    fn open(&mut self, port: &Port, _waker: &Waker) -> Result<Box<dyn Transport>, Trouble> {
        let mut world = lock(&self.0);
        world.opened.push(port.clone());
        if let Some(trouble) = &world.open_error {
            return Err(trouble.clone());
        }
        if !world.ports.iter().any(|info| info.port == *port) {
            return Err(Trouble::NoSuchPort(port.clone()));
        }
        Ok(Box::new(Line { world: self.0.clone(), generation: world.generation, received: Vec::new() }))
    }
}

struct Line {
    world: Shared,
    generation: u32,
    received: Vec<u8>,
}

impl Line {
    fn trouble(&self, world: &World) -> io::Result<()> {
        match world.error {
            Some(kind) => Err(kind.into()),
            None if self.generation != world.generation => Err(ErrorKind::BrokenPipe.into()),
            None => Ok(()),
        }
    }
}

impl Transport for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut world = lock(&self.world);
        world.reads += 1;
        match self.trouble(&world) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(0),
            result => result?,
        }
        let mut bytes = Vec::new();
        world.device.take(&mut bytes);
        for byte in bytes {
            let World { from_device, rewrite, deaf_for, .. } = &mut *world;
            let reply = from_device.push(byte, |frame| {
                let event =
                    Event::decode(frame.header.id, frame.body).expect("the device speaks its own protocol");
                rewrite(event).frame(frame.header.session, frame.header.sequence).expect("fits")
            });
            match reply {
                Some(_) if *deaf_for > 0 => *deaf_for -= 1,
                Some(frame) => self.received.extend_from_slice(&frame),
                None => {}
            }
        }
        read_received(&mut self.received, buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut world = lock(&self.world);
        self.trouble(&world)?;
        for &byte in bytes {
            let found = world.from_host.push(byte, |frame| {
                (
                    frame.header,
                    Command::decode(frame.header.id, frame.body).expect("the host speaks the protocol"),
                )
            });
            let Some((header, command)) = found else { continue };
            world.heard.push((header.sequence, command.clone()));
            if world.mute_for > 0 && command.is_sequenced() {
                world.mute_for -= 1;
                continue;
            }
            if world.mute_stops_for > 0 && matches!(command, Command::Stop | Command::EmergencyStop) {
                world.mute_stops_for -= 1;
                continue;
            }
            let frame = command.frame(header.session, header.sequence).expect("fits");
            world.device.feed(&frame);
        }
        Ok(bytes.len())
    }
}
