//! The host's link against devices that go silent, vanish, return and misbehave, in virtual time.

use slipline::link::connection::{Connection, SEEK_PERIOD};
use slipline::link::simulated::{Options, SimulatedDevice};
use slipline::link::transport::{Opener, Transport, Waker};
use slipline::link::worker::Worker;
use slipline::link::{
    Change, DriveRequest, LinkState, Outcome, Port, PortInfo, Request, Snapshot, Ticket, ToneRequest, Trouble,
};
use slipline::table::DeviceTable;
use slipline_protocol::event::State;
use slipline_protocol::limits::{KEEP_ALIVE_PERIOD_MS, MAX_RETRIES, REPLY_TIMEOUT_MS};
use slipline_protocol::version::Compatibility;
use slipline_protocol::{Command, Decoder, Event, Refusal};
use std::io::{self, ErrorKind};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

/// Changes a reply on its way.
type Rewrite = fn(Event) -> Event;

/// What lies behind the ports, and how it behaves.
struct World {
    device: SimulatedDevice,
    ports: Vec<PortInfo>,
    /// What every read and write says instead of what it would; lines opened before the last [`World::unplug`] are gone.
    error: Option<ErrorKind>,
    generation: u32,
    open_error: Option<Trouble>,
    /// Drops this many replies.
    deaf_for: u32,
    /// Drops this many commands.
    mute_for: u32,
    /// Changes a reply on its way.
    rewrite: Rewrite,
    from_host: Decoder,
    from_device: Decoder,
    /// Sequence and kind of everything the host has sent.
    heard: Vec<(u16, Command)>,
    opened: Vec<Port>,
    reads: u64,
}

impl World {
    fn unplug(&mut self) {
        self.generation += 1;
        self.ports.clear();
    }
}

/// The simulated device, claiming to be a real one: it must not be armed unasked.
fn as_real(event: Event) -> Event {
    match event {
        Event::Hello(mut identity) => {
            identity.simulated = false;
            Event::Hello(identity)
        }
        event => event,
    }
}

fn board(name: &str) -> PortInfo {
    PortInfo {
        port: Port::Serial(name.to_owned()),
        label: "Slipline".to_owned(),
        is_ours: true,
        usb_serial: Some("0001".to_owned()),
    }
}

type Shared = Arc<Mutex<World>>;

fn lock(world: &Shared) -> MutexGuard<'_, World> {
    world.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

struct Ports(Shared);

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
        if self.received.is_empty() {
            return Err(ErrorKind::WouldBlock.into());
        }
        let count = buffer.len().min(self.received.len());
        for (to, from) in buffer.iter_mut().zip(self.received.drain(..count)) {
            *to = from;
        }
        Ok(count)
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
            let frame = command.frame(header.session, header.sequence).expect("fits");
            world.device.feed(&frame);
        }
        Ok(bytes.len())
    }
}

/// A connection in a world, in virtual time.
struct Bench {
    connection: Connection<Ports>,
    world: Shared,
    now: Duration,
    tickets: u64,
    states: Vec<LinkState>,
    steps: u64,
}

impl Bench {
    fn new() -> Self {
        let world = Arc::new(Mutex::new(World {
            device: SimulatedDevice::new(Options::default()),
            ports: vec![board("A")],
            error: None,
            generation: 0,
            open_error: None,
            deaf_for: 0,
            mute_for: 0,
            rewrite: as_real,
            from_host: Decoder::new(),
            from_device: Decoder::new(),
            heard: Vec::new(),
            opened: Vec::new(),
            reads: 0,
        }));
        let mut nonce = 0u32;
        let nonces = Box::new(move || {
            nonce += 1;
            nonce.to_le_bytes()
        });
        let connection = Connection::new(Ports(world.clone()), Waker::new(|| ()), nonces);
        Self { connection, world, now: Duration::ZERO, tickets: 0, states: Vec::new(), steps: 0 }
    }

    fn connected() -> Self {
        let mut bench = Self::new();
        let ticket = bench.ask(Request::Connect(Port::Serial("A".to_owned())));
        bench.pass_ms(100);
        assert!(matches!(bench.outcome(ticket), Some(Outcome::Done { .. })));
        assert_eq!(bench.view().link, LinkState::Connected);
        bench
    }

    /// Connected, with a table, armed.
    fn armed() -> Self {
        let mut bench = Self::connected();
        let knots = (0..100).map(|i| (100.0 + f64::from(i), 0.5));
        let table = DeviceTable::from_knots((0.0, 0.1), 400_000.0, knots, 1e-6).unwrap();
        let upload = bench.ask(Request::Upload(Arc::new(table)));
        let arm = bench.ask(Request::Arm);
        bench.pass_ms(200);
        assert!(matches!(bench.outcome(upload), Some(Outcome::Done { .. })));
        assert_eq!(bench.view().upload_verified, Some(true));
        assert!(matches!(bench.outcome(arm), Some(Outcome::Done { .. })));
        bench
    }

    fn world(&self) -> MutexGuard<'_, World> {
        lock(&self.world)
    }

    fn view(&self) -> &Snapshot {
        self.connection.view()
    }

    fn ask(&mut self, request: Request) -> Ticket {
        let ticket = self.only_ask(request);
        self.step();
        ticket
    }

    /// Hands a request over without letting the link work.
    fn only_ask(&mut self, request: Request) -> Ticket {
        self.tickets += 1;
        self.connection.request(Ticket(self.tickets), request, self.now);
        Ticket(self.tickets)
    }

    fn step(&mut self) {
        self.connection.step(self.now);
        self.steps += 1;
        let link = self.view().link.clone();
        if self.states.last() != Some(&link) {
            self.states.push(link);
        }
    }

    /// Lets the device and the link go on; the link is called only when it asks for it, or bytes have come.
    fn pass_ms(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.now += Duration::from_millis(1);
            // 400 samples are 3.125 blocks.
            let blocks = self.now.as_micros() as u64 * 4 / 10 / 128
                - (self.now.as_micros() as u64 - 1000) * 4 / 10 / 128;
            self.world().device.advance(blocks, |_| ());
            let is_due = self.connection.deadline(self.now).is_some_and(|due| due <= self.now);
            let has_answered = self.world().error.is_none();
            if is_due || (has_answered && self.connection.is_open()) {
                self.step();
            }
        }
    }

    fn outcome(&self, ticket: Ticket) -> Option<Outcome> {
        self.view().outcome(ticket).cloned()
    }

    fn state(&self) -> State {
        self.view().status.unwrap().state
    }
}

fn drive(boundary_m: f64) -> Request {
    Request::Drive(DriveRequest::of(vec![ToneRequest { slot: 0, boundary_m, level: 0.5, phase_turns: 0.0 }]))
}

const LOST_AFTER_MS: u64 = (REPLY_TIMEOUT_MS * (MAX_RETRIES + 1)) as u64;

#[test]
fn a_lost_reply_is_asked_for_again_and_the_command_is_done_once() {
    //
    let mut bench = Bench::armed();
    let duplicates = bench.view().status.unwrap().counters.duplicates;
    bench.world().deaf_for = 1;
    let ticket = bench.ask(drive(0.05));
    bench.pass_ms(2 * u64::from(REPLY_TIMEOUT_MS));
    assert!(matches!(bench.outcome(ticket), Some(Outcome::Done { .. })));
    bench.pass_ms(u64::from(KEEP_ALIVE_PERIOD_MS) + 10);
    assert_eq!(bench.view().status.unwrap().counters.duplicates, duplicates + 1, "answered from the cache");
    let drives = bench.view().journal.iter().filter(|entry| matches!(entry.change, Change::Drive(_))).count();
    assert_eq!(drives, 1);
}

#[test]
fn a_device_that_answers_no_more_is_lost_after_three_repeats_of_the_same_number() {
    //
    let mut bench = Bench::armed();
    bench.ask(Request::AutoReconnect(false));
    bench.world().deaf_for = u32::MAX;
    bench.world().heard.clear();
    let ticket = bench.ask(Request::Disarm);
    bench.pass_ms(LOST_AFTER_MS + 10);
    assert_eq!(bench.view().link, LinkState::Lost(Trouble::Silent));
    assert_eq!(bench.outcome(ticket), Some(Outcome::NotConnected));
    let world = bench.world();
    let disarms: Vec<u16> =
        world.heard.iter().filter(|(_, c)| *c == Command::Disarm).map(|(s, _)| *s).collect();
    assert_eq!(disarms.len() as u32, 1 + MAX_RETRIES);
    assert!(disarms.iter().all(|sequence| *sequence == disarms[0]));
}

#[test]
fn a_device_that_never_answers_is_given_up_with_a_reason() {
    let mut bench = Bench::new();
    bench.world().deaf_for = u32::MAX;
    let ticket = bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(LOST_AFTER_MS + 10);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    assert_eq!(bench.view().trouble, Some(Trouble::NoAnswer(Port::Serial("A".to_owned()))));
    assert!(matches!(bench.outcome(ticket), Some(Outcome::Refused(_))));
}

#[test]
fn a_device_that_comes_back_under_another_name_is_found_and_stays_disarmed() {
    //
    let mut bench = Bench::armed();
    bench.ask(drive(0.05));
    bench.pass_ms(300);
    assert_eq!(bench.state(), State::Driving);
    bench.states = vec![LinkState::Connected];
    bench.world().unplug();
    bench.pass_ms(200);
    bench.world().ports = vec![board("B")];
    // Within two seconds: the next look, and a greeting.
    bench.pass_ms(SEEK_PERIOD.as_millis() as u64 + 300);
    assert_eq!(
        bench.states,
        [
            LinkState::Connected,
            LinkState::Lost(Trouble::Gone),
            LinkState::Reconnecting(Trouble::Gone),
            LinkState::Connected
        ]
    );
    assert_eq!(bench.view().port, Some(Port::Serial("B".to_owned())));
    bench.pass_ms(300);
    assert_eq!(bench.state(), State::Idle);
    assert!(bench.view().table.active.is_some(), "what it holds was read again");
    let rearmed = bench.world().heard.iter().filter(|(_, command)| *command == Command::Arm).count();
    assert_eq!(rearmed, 1, "only the first time");
}

#[test]
fn a_lost_device_is_not_looked_for_when_that_is_switched_off() {
    let mut bench = Bench::connected();
    bench.ask(Request::AutoReconnect(false));
    bench.world().unplug();
    bench.pass_ms(50);
    bench.world().ports = vec![board("A")];
    bench.pass_ms(5000);
    assert_eq!(bench.view().link, LinkState::Lost(Trouble::Gone));
    assert_eq!(bench.world().opened.len(), 1);
    bench.ask(Request::AutoReconnect(true));
    bench.pass_ms(300);
    assert_eq!(bench.view().link, LinkState::Connected);
}

#[test]
fn a_device_that_another_program_keeps_taking_is_left_to_it() {
    let mut bench = Bench::connected();
    let refused: Rewrite = |event| match as_real(event) {
        Event::Status(_) => Event::Refused(Refusal::StaleSession),
        event => event,
    };
    bench.world().rewrite = refused;
    bench.pass_ms(20_000);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    assert_eq!(bench.view().trouble, Some(Trouble::SessionEnded));
    let hellos = bench.world().heard.iter().filter(|(_, c)| matches!(c, Command::Hello(_))).count();
    assert!((2..=4).contains(&hellos), "{hellos}");
    // Asked for again, it is tried again.
    bench.world().rewrite = as_real;
    bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(100);
    assert_eq!(bench.view().link, LinkState::Connected);
}

#[test]
fn another_board_in_its_place_is_not_taken_for_it() {
    let mut bench = Bench::connected();
    bench.world().unplug();
    bench.pass_ms(50);
    let mut other = board("A");
    other.usb_serial = Some("0002".to_owned());
    bench.world().ports = vec![other];
    bench.pass_ms(2000);
    assert!(matches!(bench.view().link, LinkState::Reconnecting(_)));
    assert_eq!(bench.world().opened.len(), 1, "not even opened");
}

#[test]
fn a_device_of_another_version_can_be_identified_and_stopped_and_no_more() {
    //
    let foreign: [(Rewrite, Compatibility); 3] = [
        (|event| reversion(event, |v| v.major += 1), Compatibility::UpdateHost),
        (|event| reversion(event, |v| v.major = 0), Compatibility::FlashDevice),
        (|event| reversion(event, |v| v.schema[0] ^= 1), Compatibility::FlashDevice),
    ];
    for (rewrite, want) in foreign {
        let mut bench = Bench::new();
        bench.world().rewrite = rewrite;
        bench.ask(Request::Connect(Port::Serial("A".to_owned())));
        bench.pass_ms(2000);
        assert_eq!(bench.view().link, LinkState::Connected);
        assert_eq!(bench.view().compatibility, Some(want));
        assert!(bench.view().identity.is_some(), "identified");
        for request in [Request::Arm, drive(0.05), Request::Store, Request::ClearFaults] {
            let ticket = bench.ask(request);
            assert_eq!(bench.outcome(ticket), Some(Outcome::Refused(want.sentence().to_owned())));
        }
        let stop = bench.ask(Request::Stop);
        bench.pass_ms(50);
        assert!(matches!(bench.outcome(stop), Some(Outcome::Done { .. })));
        assert!(bench.world().heard.iter().all(|(_, c)| matches!(c, Command::Hello(_) | Command::Stop)));
    }
}

fn reversion(event: Event, change: fn(&mut slipline_protocol::version::Version)) -> Event {
    match as_real(event) {
        Event::Hello(mut identity) => {
            change(&mut identity.version);
            Event::Hello(identity)
        }
        event => event,
    }
}

#[test]
fn a_device_with_a_newer_minor_version_is_driven_all_the_same() {
    let mut bench = Bench::new();
    bench.world().rewrite = |event| reversion(event, |v| v.minor += 1);
    bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(100);
    assert_eq!(bench.view().compatibility, Some(Compatibility::DeviceNewer));
    let arm = bench.ask(Request::Arm);
    bench.pass_ms(50);
    assert!(matches!(bench.outcome(arm), Some(Outcome::Done { .. })));
}

#[test]
fn every_error_of_a_port_is_one_loss_and_no_busy_loop() {
    // UnexpectedEof stands for a read of Ok(0) here.
    for kind in [
        ErrorKind::UnexpectedEof,
        ErrorKind::BrokenPipe,
        ErrorKind::ConnectionReset,
        ErrorKind::NotConnected,
        ErrorKind::PermissionDenied,
        ErrorKind::ResourceBusy,
        ErrorKind::Other,
    ] {
        let mut bench = Bench::connected();
        bench.ask(Request::AutoReconnect(false));
        bench.states.clear();
        bench.world().error = Some(kind);
        let (steps, reads) = (bench.steps, bench.world().reads);
        bench.pass_ms(10_000);
        assert_eq!(bench.states.len(), 1, "{kind:?}: {:?}", bench.states);
        assert!(matches!(bench.states[0], LinkState::Lost(_)), "{kind:?}");
        assert!(bench.steps - steps <= 2, "{kind:?}: {} steps", bench.steps - steps);
        assert!(bench.world().reads - reads <= 2, "{kind:?}");
        assert!(bench.view().trouble.is_some());
    }
}

#[test]
fn a_port_that_only_says_not_yet_is_not_hammered_and_lost_for_its_silence() {
    //
    for kind in [ErrorKind::TimedOut, ErrorKind::WouldBlock] {
        let mut bench = Bench::connected();
        bench.ask(Request::AutoReconnect(false));
        bench.world().error = Some(kind);
        let steps = bench.steps;
        bench.pass_ms(LOST_AFTER_MS + 250);
        assert_eq!(bench.view().link, LinkState::Lost(Trouble::Silent), "{kind:?}");
        // A write that does not go through is tried every millisecond.
        assert!(bench.steps - steps <= LOST_AFTER_MS + 260);
    }
}

#[test]
fn a_port_that_cannot_be_opened_says_why_and_is_not_tried_again() {
    let port = Port::Serial("A".to_owned());
    for trouble in
        [Trouble::Busy(port.clone()), Trouble::NoPermission(port.clone()), Trouble::NoSuchPort(port.clone())]
    {
        let mut bench = Bench::new();
        bench.world().open_error = Some(trouble.clone());
        let ticket = bench.ask(Request::Connect(port.clone()));
        assert_eq!(bench.outcome(ticket), Some(Outcome::Refused(trouble.to_string())));
        bench.pass_ms(5000);
        assert_eq!(bench.view().link, LinkState::Disconnected);
        assert_eq!(bench.world().opened.len(), 1);
    }
}

#[test]
fn at_rest_the_link_wakes_only_for_its_keep_alives() {
    let bench = Bench::connected();
    let due = bench.connection.deadline(bench.now).unwrap();
    assert!(due > bench.now && due <= bench.now + Duration::from_millis(u64::from(KEEP_ALIVE_PERIOD_MS)));
}

#[test]
fn the_newest_drive_wins_and_a_stop_overtakes_all_of_them() {
    let mut bench = Bench::armed();
    bench.world().heard.clear();
    let tickets: Vec<Ticket> = [0.01, 0.02, 0.03, 0.04].map(|x_m| bench.only_ask(drive(x_m))).to_vec();
    let stop = bench.ask(Request::Stop);
    bench.pass_ms(50);
    assert!(tickets.iter().all(|ticket| bench.outcome(*ticket) == Some(Outcome::Superseded)));
    assert!(matches!(bench.outcome(stop), Some(Outcome::Done { .. })));
    assert!(!bench.world().heard.iter().any(|(_, command)| matches!(command, Command::Drive(_))));
}

#[test]
fn a_drive_that_was_lost_before_a_stop_does_not_come_back_after_it() {
    let mut bench = Bench::armed();
    bench.world().mute_for = 1;
    bench.ask(drive(0.05));
    let stop = bench.ask(Request::Stop);
    bench.pass_ms(2000);
    assert!(matches!(bench.outcome(stop), Some(Outcome::Done { .. })));
    assert_eq!(bench.state(), State::Armed, "silent, and in step with the device");
    let again = bench.ask(drive(0.06));
    bench.pass_ms(300);
    assert!(matches!(bench.outcome(again), Some(Outcome::Done { .. })));
    assert_eq!(bench.state(), State::Driving);
}

#[test]
fn a_disconnect_stops_and_disarms_first() {
    let mut bench = Bench::armed();
    bench.ask(drive(0.05));
    bench.pass_ms(100);
    bench.ask(Request::Disconnect);
    bench.pass_ms(100);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    let world = bench.world();
    let last: Vec<&Command> = world.heard.iter().rev().take(2).map(|(_, command)| command).collect();
    assert_eq!(last, [&Command::Disarm, &Command::Stop]);
    assert!(world.device.is_muted());
}

#[test]
fn values_out_of_range_never_reach_the_wire() {
    let mut bench = Bench::armed();
    bench.world().heard.clear();
    let tone = |boundary_m, level, phase_turns| ToneRequest { slot: 0, boundary_m, level, phase_turns };
    let good = DriveRequest::of(vec![tone(0.05, 0.5, 0.0)]);
    for (request, field) in [
        (DriveRequest::of(vec![tone(f64::NAN, 0.5, 0.0)]), "boundary"),
        (DriveRequest::of(vec![tone(0.2, 0.5, 0.0)]), "boundary"),
        (DriveRequest::of(vec![tone(0.05, 1.1, 0.0)]), "level"),
        (DriveRequest::of(vec![tone(0.05, 0.5, f64::INFINITY)]), "phase"),
        (DriveRequest::of(vec![ToneRequest { slot: 16, ..tone(0.05, 0.5, 0.0) }]), "slot"),
        (DriveRequest::of(vec![tone(0.05, 0.1, 0.0); 17]), "17 tones"),
        (DriveRequest { master_db: 1.0, ..good.clone() }, "master"),
        (DriveRequest { glide_s: f64::NAN, ..good }, "glide"),
    ] {
        let ticket = bench.ask(Request::Drive(request));
        match bench.outcome(ticket) {
            Some(Outcome::Refused(sentence)) => assert!(sentence.contains(field), "{sentence}"),
            other => panic!("{field}: {other:?}"),
        }
    }
    assert!(bench.world().heard.iter().all(|(_, command)| !matches!(command, Command::Drive(_))));
}

#[test]
fn a_panic_anywhere_in_the_program_stops_the_drive() {
    // R-61, in real time: the wait is bounded, its length is not asserted.
    let bench = Bench::new();
    let worker = Worker::spawn_with(Ports(bench.world.clone()), || ()).unwrap();
    let connect = worker.send(Request::Connect(Port::Serial("A".to_owned())));
    let patience = Duration::from_secs(10);
    assert!(matches!(worker.wait(connect, patience), Some(Outcome::Done { .. })));
    slipline::link::worker::stop_on_panic(worker.handle());
    let painted = std::thread::spawn(|| panic!("a mistake while painting"));
    assert!(painted.join().is_err());
    let stopped = worker.handle().wait_for(patience, |snapshot| {
        snapshot.journal.iter().any(|entry| entry.change == Change::Stop).then_some(())
    });
    assert_eq!(stopped, Some(()));
    assert!(lock(&bench.world).heard.iter().any(|(_, command)| *command == Command::Stop));
}
