//! A port with a simulated device that can be plugged in and pulled out, and the link on it, in virtual time.

use slipline_instrument::Link;
use slipline_link::connection::Connection;
use slipline_link::protocol::event::ResetCause;
use slipline_link::protocol::version::Minor;
use slipline_link::protocol::{Command, Decoder, Event, Header, Refusal};
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_link::transport::{Opener, Transport, Waker};
use slipline_link::{LinkError, Port, PortInfo, Request, Snapshot, Ticket};
use std::cell::RefCell;
use std::io;
use std::rc::Rc;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A simulated device and its cable.
struct PluggablePort {
    device: SimulatedDevice,
    is_plugged: bool,
    /// Refusal of every drive, in place of the device's answer.
    refusal: Option<Refusal>,
    from_host: Decoder,
    refused: Vec<u8>,
    /// Hash of all codes that the device has sent: FNV-1a by words of four codes.
    digest: u64,
}

impl PluggablePort {
    /// Runs the device for this number of blocks.
    fn send(&mut self, blocks: u64) {
        let digest = &mut self.digest;
        self.device.advance(blocks, |sent| {
            // By four codes: tests are not optimised, and every code of every test comes through here.
            for four in sent.codes.as_chunks().0 {
                let [first, second, third, fourth] = four.map(u64::from);
                let word = first | second << 16 | third << 32 | fourth << 48;
                *digest = (*digest ^ word).wrapping_mul(0x0100_0000_01b3);
            }
        });
    }
}

/// Reads what a device has sent, as `change` passes it on; an error while its cable is out.
pub(crate) fn read_from(
    device: &mut SimulatedDevice,
    is_plugged: bool,
    buffer: &mut [u8],
    change: impl FnOnce(Vec<u8>) -> Vec<u8>,
) -> io::Result<usize> {
    if !is_plugged {
        return Err(io::ErrorKind::BrokenPipe.into());
    }
    let mut bytes = Vec::new();
    device.take(&mut bytes);
    let bytes = change(bytes);
    if bytes.is_empty() {
        return Err(io::ErrorKind::WouldBlock.into());
    }
    assert!(bytes.len() <= buffer.len(), "the answers of a millisecond fit a read");
    buffer[..bytes.len()].copy_from_slice(&bytes);
    Ok(bytes.len())
}

pub(crate) struct PluggableTransport(Arc<Mutex<PluggablePort>>);

impl Transport for PluggableTransport {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let PluggablePort { device, is_plugged, refused, .. } = &mut *self.0.lock().unwrap();
        read_from(device, *is_plugged, buffer, |mut bytes| {
            bytes.append(refused);
            bytes
        })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut port = self.0.lock().unwrap();
        if !port.is_plugged {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let Some(refusal) = port.refusal else {
            port.device.feed(bytes);
            return Ok(bytes.len());
        };
        for &byte in bytes {
            let command = port
                .from_host
                .push(byte, |frame| (frame.header, Command::decode(frame.header.id, frame.body).unwrap()));
            let Some((header, command)) = command else { continue };
            let Header { session, sequence, .. } = header;
            if let Command::Drive(_) = command {
                let answer = Event::Refused(refusal).frame_for(Minor::FIRST, session, sequence).unwrap();
                port.refused.extend_from_slice(&answer);
            } else {
                port.device.feed(&command.frame_for(Minor::FIRST, session, sequence).unwrap());
            }
        }
        Ok(bytes.len())
    }
}

pub(crate) struct PluggableOpener(Arc<Mutex<PluggablePort>>);

impl Opener for PluggableOpener {
    type Transport = PluggableTransport;

    fn list(&mut self) -> Vec<PortInfo> {
        if self.0.lock().unwrap().is_plugged { vec![PortInfo::simulated()] } else { Vec::new() }
    }

    fn open(&mut self, port: &Port, _waker: &Waker) -> Result<PluggableTransport, LinkError> {
        if self.0.lock().unwrap().is_plugged {
            Ok(PluggableTransport(Arc::clone(&self.0)))
        } else {
            Err(LinkError::NoSuchPort(port.clone()))
        }
    }
}

/// Replacement of the link worker: the connection, stepped by the test in virtual time.
pub(crate) struct SteppedWorker {
    pub(crate) connection: Connection<PluggableOpener>,
    port: Arc<Mutex<PluggablePort>>,
    now: Duration,
    tickets: u64,
    pub(crate) sent: Vec<Request>,
    /// The window's event loop hangs: it gives the link no signs of life.
    pub(crate) is_hung: bool,
}

impl SteppedWorker {
    /// A simulated device, perhaps with inputs, at its port, and an idle link.
    pub(crate) fn new(is_plugged: bool, inputs: Option<Box<dyn SimulatedInputs>>) -> Self {
        let device = match inputs {
            Some(inputs) => SimulatedDevice::with_inputs(Options::default(), inputs),
            None => SimulatedDevice::new(Options::default()),
        };
        let port = Arc::new(Mutex::new(PluggablePort {
            device,
            is_plugged,
            refusal: None,
            from_host: Decoder::new(),
            refused: Vec::new(),
            digest: 0xcbf2_9ce4_8422_2325,
        }));
        let mut nonce = 0u32;
        let nonces = Box::new(move || {
            nonce += 1;
            nonce.to_le_bytes()
        });
        let mut connection = Connection::new(PluggableOpener(Arc::clone(&port)), Waker::new(|| {}), nonces);
        connection.keep_frames();
        connection.watch_driver();
        Self { connection, port, now: Duration::ZERO, tickets: 0, sent: Vec::new(), is_hung: false }
    }

    /// Pulls the cable or plugs it in; the device restarts.
    pub(crate) fn plug(&self, is_plugged: bool) {
        let mut port = self.port.lock().unwrap();
        port.is_plugged = is_plugged;
        if is_plugged {
            port.device.restart(ResetCause::PowerOn);
        }
    }

    /// A digest of all codes that the device has sent.
    pub(crate) fn digest(&self) -> u64 {
        self.port.lock().unwrap().digest
    }

    /// Refuses every drive from now on, or accepts them again.
    pub(crate) fn refuse_drives(&self, refusal: Option<Refusal>) {
        self.port.lock().unwrap().refusal = refusal;
    }

    /// Runs the device and the link.
    pub(crate) fn advance(&mut self, time: Duration) {
        const STEP: Duration = Duration::from_millis(1);
        let end = self.now + time;
        while self.now < end {
            self.now += STEP;
            // 400 kS/s in blocks of 128 are 3.125 blocks a millisecond.
            let blocks = |time: Duration| time.as_millis() as u64 * 25 / 8;
            let due = blocks(self.now) - blocks(self.now - STEP);
            self.port.lock().unwrap().send(due);
            self.connection.step(self.now);
            if self.connection.take_sign_wanted() && !self.is_hung {
                self.connection.sign_of_life(self.now);
            }
        }
    }
}

pub(crate) struct SteppedLink(pub(crate) Rc<RefCell<SteppedWorker>>);

impl Link for SteppedLink {
    fn send(&self, request: Request) -> Ticket {
        let mut worker = self.0.borrow_mut();
        worker.tickets += 1;
        let (ticket, now) = (Ticket(worker.tickets), worker.now);
        worker.sent.push(request.clone());
        worker.connection.request(ticket, request, now);
        worker.connection.step(now);
        ticket
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let mut worker = self.0.borrow_mut();
        // As the real worker does: this call numbers the changes.
        worker.connection.take_changes();
        Arc::new(worker.connection.view().clone())
    }
}
