//! Host and device of different minors, R-23: the old one is the product, the new one the same sources with a rehearsal of
//! the next minor (`tests/next`). It adds a command and its event, a refusal, and a fault; real hosts and real devices
//! of both talk to each other here. Hosts and devices of released minors talk to the product in transcripts.rs.

/// A host's link and a simulated device, each of one of the two crates, in virtual time.
macro_rules! pair {
    ($pair:ident, $host:ident, $device:ident, $protocol:ident) => {
        mod $pair {
            use std::io;
            use std::sync::{Arc, Mutex};
            use std::time::Duration;
            use $device::simulator::{Options, SimulatedDevice};
            use $host::connection::Connection;
            use $host::transport::{Opener, Transport, Waker, read_received};
            use $host::{
                DeviceTable, LinkError, LinkState, Outcome, Port, PortInfo, Request, Snapshot, Sounding,
                Ticket,
            };
            use $protocol::Decoder;

            /// The device, and the ids of the messages that went past.
            pub(crate) struct Line {
                pub(crate) device: SimulatedDevice,
                from_host: Decoder,
                from_device: Decoder,
                pub(crate) commands: Vec<u8>,
                pub(crate) events: Vec<(u8, Vec<u8>)>,
            }

            pub(crate) struct End {
                line: Arc<Mutex<Line>>,
                received: Vec<u8>,
            }

            impl Transport for End {
                fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                    let mut line = self.line.lock().unwrap();
                    let mut bytes = Vec::new();
                    line.device.take(&mut bytes);
                    for &byte in &bytes {
                        let event =
                            line.from_device.push(byte, |frame| (frame.header.id, frame.body.to_vec()));
                        line.events.extend(event);
                    }
                    self.received.extend(bytes);
                    read_received(&mut self.received, buffer)
                }

                fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                    let mut line = self.line.lock().unwrap();
                    for &byte in bytes {
                        let command = line.from_host.push(byte, |frame| frame.header.id);
                        line.commands.extend(command);
                    }
                    line.device.feed(bytes);
                    Ok(bytes.len())
                }
            }

            pub(crate) struct Lines(Arc<Mutex<Line>>);

            impl Opener for Lines {
                type Transport = End;

                fn list(&mut self) -> Vec<PortInfo> {
                    Vec::new()
                }

                fn open(&mut self, _: &Port, _: &Waker) -> Result<End, LinkError> {
                    Ok(End { line: self.0.clone(), received: Vec::new() })
                }
            }

            pub(crate) struct Pair {
                pub(crate) line: Arc<Mutex<Line>>,
                connection: Connection<Lines>,
                now: Duration,
                tickets: u64,
            }

            impl Pair {
                /// Connected to a device whose unit has this name.
                pub(crate) fn connected(unit: &[u8; 12]) -> Self {
                    let options = Options { unit: *unit, ..Options::default() };
                    let line = Arc::new(Mutex::new(Line {
                        device: SimulatedDevice::new(options),
                        from_host: Decoder::new(),
                        from_device: Decoder::new(),
                        commands: Vec::new(),
                        events: Vec::new(),
                    }));
                    let nonces = Box::new(|| *b"once");
                    let connection = Connection::new(Lines(line.clone()), Waker::new(|| ()), nonces);
                    let mut pair = Self { line, connection, now: Duration::ZERO, tickets: 0 };
                    pair.ask(Request::Connect(Port::Serial("A".to_owned())));
                    assert_eq!(pair.view().link, LinkState::Connected);
                    pair
                }

                pub(crate) fn view(&self) -> &Snapshot {
                    self.connection.view()
                }

                /// How a request ends within 300 ms.
                pub(crate) fn ask(&mut self, request: Request) -> Option<Outcome> {
                    self.tickets += 1;
                    let ticket = Ticket(self.tickets);
                    self.connection.request(ticket, request, self.now);
                    for _ in 0..300 {
                        self.now += Duration::from_millis(1);
                        // 3 blocks of 128 codes at 400 kS/s are about a millisecond.
                        self.line.lock().unwrap().device.advance(3, |_| ());
                        self.connection.step(self.now);
                    }
                    self.view().outcome(ticket).cloned()
                }

                pub(crate) fn is_done(&mut self, request: Request) -> bool {
                    matches!(self.ask(request), Some(Outcome::Done { .. }))
                }

                /// Everything that both minors can do.
                pub(crate) fn drive_and_stop(&mut self) {
                    let knots = (0..100).map(|i| (100.0 + f64::from(i), 0.5));
                    let table = DeviceTable::from_knots((0.0, 0.1), 4e5, knots, 1e-6).unwrap();
                    assert!(self.is_done(Request::Upload(Arc::new(table))));
                    assert!(self.is_done(Request::Arm));
                    let drive = $host::DriveRequest::at(&[(0.05, 0.5)]);
                    assert!(self.is_done(Request::Play(Sounding::Drive(drive))));
                    assert!(self.is_done(Request::Refresh));
                    assert!(self.is_done(Request::Stop));
                    assert!(self.is_done(Request::Disarm));
                }

                /// The messages that the device has sent: id and body.
                pub(crate) fn sent(&self) -> Vec<(u8, Vec<u8>)> {
                    self.line.lock().unwrap().events.clone()
                }
            }
        }
    };
}

pair!(old_old, slipline_link, slipline_link, slipline_protocol);
pair!(new_new, slipline_link_next, slipline_link_next, slipline_protocol_next);
pair!(old_new, slipline_link, slipline_link_next, slipline_protocol);
pair!(new_old, slipline_link_next, slipline_link, slipline_protocol_next);

/// The faults of the latest status that was sent, as they stand on the wire: set and first.
fn faults(sent: &[(u8, Vec<u8>)]) -> (u32, Option<u8>) {
    let (_, body) = sent.iter().rev().find(|(id, _)| *id == 0x83).unwrap();
    // The state, the set as a varint, the option.
    let (mut set, mut at) = (0, 1);
    loop {
        set |= u32::from(body[at] & 0x7f) << (7 * (at - 1));
        at += 1;
        if body[at - 1] < 0x80 {
            break;
        }
    }
    (set, (body[at] == 1).then(|| body[at + 1]))
}

/// The numbers of the refusals that were sent.
fn refusals(sent: &[(u8, Vec<u8>)]) -> Vec<u8> {
    sent.iter().filter(|(id, _)| *id == 0x91).map(|(_, body)| body[0]).collect()
}

const SOUND: &[u8; 12] = b"sound-coil--";
const OPEN: &[u8; 12] = b"open-coil---";

/// Ids and numbers that the new minor adds, and what stands in for them. They move when the product's minor grows.
const MEASURE_COIL: u8 = 0x7f;
const COIL_OPEN_REFUSAL: u8 = last(slipline_protocol_next::Refusal::ROWS);
const NOT_SUPPORTED: u8 = 18;
const COIL_OPEN_FAULT: u8 = last(slipline_protocol_next::event::Fault::ROWS);
const OVERHEAT: u8 = 3;

/// The number of the variant that was added last.
const fn last(rows: &[slipline_protocol_next::schema::VariantRow]) -> u8 {
    rows[rows.len() - 1].number
}

#[test]
fn the_rehearsal_is_one_minor_ahead_of_the_product() {
    let next = slipline_protocol_next::version::MINOR;
    assert_eq!(next, slipline_protocol::version::MINOR + 1);
    let added = |since: u8| since == next;
    assert!(
        slipline_protocol_next::Command::TABLE.iter().any(|row| added(row.since) && row.id == MEASURE_COIL)
    );
    assert!(slipline_protocol_next::Refusal::ROWS.iter().any(|row| added(row.since)));
    assert!(slipline_protocol_next::event::Fault::ROWS.iter().any(|row| added(row.since)));
}

#[test]
fn two_sides_of_the_new_minor_use_what_it_added() {
    use slipline_link_next::{Outcome, Request};
    let mut pair = new_new::Pair::connected(SOUND);
    assert_eq!(pair.view().compatibility, Some(slipline_protocol_next::version::Compatibility::Same));
    assert_eq!(pair.ask(Request::MeasureCoil), Some(Outcome::Done { at: 3200 }));
    pair.drive_and_stop();

    let mut pair = new_new::Pair::connected(OPEN);
    assert!(!pair.is_done(Request::Arm));
    assert!(refusals(&pair.sent()).contains(&COIL_OPEN_REFUSAL));
    pair.ask(Request::Refresh);
    assert_eq!(faults(&pair.sent()), (1 << COIL_OPEN_FAULT, Some(COIL_OPEN_FAULT)));
}

#[test]
fn a_newer_host_drives_an_older_device_and_does_not_offer_what_it_lacks() {
    use slipline_link_next::{Outcome, Request};
    let mut pair = new_old::Pair::connected(SOUND);
    assert_eq!(pair.view().compatibility, Some(slipline_protocol_next::version::Compatibility::DeviceOlder));
    assert_eq!(pair.ask(Request::MeasureCoil), Some(Outcome::DeviceTooOld));
    pair.drive_and_stop();
    assert_eq!(pair.ask(Request::MeasureCoil), Some(Outcome::DeviceTooOld));
    assert!(!pair.line.lock().unwrap().commands.contains(&MEASURE_COIL), "nothing newer is ever sent");
    assert_eq!(refusals(&pair.sent()), [0; 0], "the device understood every command");
}

#[test]
fn a_newer_device_serves_an_older_host_with_what_that_knows() {
    use slipline_link::Request;
    let mut pair = old_new::Pair::connected(SOUND);
    assert_eq!(pair.view().compatibility, Some(slipline_protocol::version::Compatibility::DeviceNewer));
    pair.drive_and_stop();

    let mut pair = old_new::Pair::connected(OPEN);
    assert!(!pair.is_done(Request::Arm));
    let refusals = refusals(&pair.sent());
    assert!(refusals.contains(&NOT_SUPPORTED), "the old refusal in the place of the new one: {refusals:?}");
    assert!(!refusals.contains(&COIL_OPEN_REFUSAL));
    pair.ask(Request::Refresh);
    assert_eq!(
        faults(&pair.sent()),
        (1 << OVERHEAT, Some(OVERHEAT)),
        "the old fault in the place of the new one"
    );
    assert!(!pair.is_done(Request::Arm));
    assert_eq!(pair.view().status.map(|status| status.faults.0), Some(1 << OVERHEAT));
}

#[test]
fn a_newer_device_does_not_know_a_new_command_from_an_older_host() {
    use slipline_protocol_next::command::{CoilTest, Hello};
    use slipline_protocol_next::version::{Minor, Version};
    use slipline_protocol_next::{Command, Decoder};
    let pair = old_new::Pair::connected(SOUND);
    let mut line = pair.line.lock().unwrap();
    let (mut decoder, mut bytes) = (Decoder::new(), Vec::new());
    // A repeat of the hello returns the session's number.
    let hello = Command::Hello(Hello {
        version: Version { minor: slipline_protocol::version::MINOR, ..Version::OURS },
        nonce: *b"once",
    });
    line.device.feed(&hello.frame_for(Minor::OURS, 0, 9).unwrap());
    line.device.take(&mut bytes);
    let session = bytes.iter().find_map(|&byte| decoder.push(byte, |frame| frame.header.session)).unwrap();
    // Numbers 1 to 7 were the host's: to ask for the upkeep, the board, its profile and its wear, and the inputs, to look at the
    // table, and to arm a device that is simulated.
    let ask = Command::MeasureCoil(CoilTest { current_ma: 5 }).frame_for(Minor::OURS, session, 8).unwrap();
    line.device.feed(&ask);
    line.device.take(&mut bytes);
    let answers: Vec<(u8, Vec<u8>)> = bytes
        .iter()
        .filter_map(|&byte| decoder.push(byte, |frame| (frame.header.id, frame.body.to_vec())))
        .collect();
    assert_eq!(answers.last(), Some(&(0x91, vec![0, MEASURE_COIL])), "an unknown message");
}

#[test]
fn two_sides_of_the_old_minor_are_the_same() {
    let mut pair = old_old::Pair::connected(SOUND);
    assert_eq!(pair.view().compatibility, Some(slipline_protocol::version::Compatibility::Same));
    pair.drive_and_stop();
    assert_eq!(refusals(&pair.sent()), [0; 0], "the device understood every command");
}
