//! A blocking client: each call returns after the device has answered. While it waits, pauses or computes in
//! these calls, it gives the signs of life that the link requires while the device is armed.

use super::{ClientError, StandingFaults};
use crate::Link;
use crate::rig::PreparedRig;
use slipline_link::DeviceTable;
use slipline_link::native::{Handle, SystemOpener, Worker};
use slipline_link::protocol::event::{Identity, State};
use slipline_link::protocol::profile::ActuatorProfile;
use slipline_link::protocol::version::Compatibility;
use slipline_link::simulator::Options;
use slipline_link::{Outcome, Port, Request, Snapshot, Sounding, Ticket};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time limit for opening a port and the handshake; usually the link fails earlier.
const CONNECTING: Duration = Duration::from_secs(5);
/// Time limit of a request. The longest is a table over a slow link: 47 chunks of a few milliseconds each, and
/// repeats.
const PATIENCE: Duration = Duration::from_secs(30);
/// Time limit for stop and disarm before the port is closed.
const CLOSING: Duration = Duration::from_secs(1);
/// The lease of a device that a program arms.
pub const LEASE: Duration = Duration::from_secs(60);
/// Time between two updates of the device's state.
pub(super) const GLANCE: Duration = Duration::from_millis(50);
/// Updates within which the drive must have faded.
const FADING: usize = 100;

/// A link whose outcomes a program awaits: the link's thread, or in tests a link in virtual time.
pub trait BlockingLink: Link {
    /// Waits up to `patience` for a request's outcome, with signs of life.
    fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome>;
    /// Sleeps, with signs of life.
    fn pause(&self, time: Duration);
    /// Signals that this program is alive.
    fn sign_of_life(&self);
    /// As [`Link::send`]; the outcome is kept until [`BlockingLink::release`], also where other threads send requests.
    fn send_awaited(&self, request: Request) -> Ticket {
        self.send(request)
    }
    /// Ends the wait for an outcome.
    fn release(&self, _ticket: Ticket) {}
    /// Whether the user has interrupted the call under way, once for each interruption.
    fn take_interruption(&self) -> bool {
        false
    }
}

impl Link for Worker {
    fn send(&self, request: Request) -> Ticket {
        Handle::send(self, request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Handle::snapshot(self)
    }
}

impl BlockingLink for Worker {
    fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        Self::wait(self, ticket, patience)
    }

    fn pause(&self, time: Duration) {
        Self::pause(self, time);
    }

    fn sign_of_life(&self) {
        Handle::sign_of_life(self);
    }

    fn send_awaited(&self, request: Request) -> Ticket {
        Handle::send_awaited(self, request)
    }

    fn release(&self, ticket: Ticket) {
        Handle::release(self, ticket);
    }
}

/// A device in use. When it is dropped with the link's thread, the device is stopped and disarmed.
///
/// Its calls may come from several threads: each has its own outcome. A newer drive or a stop supersedes a drive that the
/// device has not accepted yet ([`ClientError::Superseded`]), and a stop or a disarm ends the procedures and waits of other
/// threads ([`Client::stops`]).
pub struct Client<W = Worker> {
    link: W,
    /// Stops and disarms by calls.
    stops: AtomicU32,
    /// Requests of a level hold whose outcomes are awaited.
    of_hold: Mutex<Vec<Ticket>>,
    /// Number of stalls of this program when the device was armed.
    stalls_before: AtomicU32,
    /// Number of leases that were over then.
    leases_before: AtomicU32,
}

impl Client {
    /// A client without a connection; the simulated device is wired to `rig`, if there is one.
    ///
    /// # Errors
    /// [`ClientError::Thread`].
    pub fn new(rig: Option<&PreparedRig>) -> Result<Self, ClientError> {
        Ok(Self::over(wired(rig)?))
    }

    /// As [`Client::new`], with a simulated device of these options, for example with wires between its pins.
    ///
    /// # Errors
    /// [`ClientError::Thread`].
    pub fn simulating(options: Options) -> Result<Self, ClientError> {
        Ok(Self::over(Worker::spawn_with(SystemOpener::with_options(options), || ())?))
    }

    /// A handle of the link, for another thread.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.link.handle()
    }

    /// A function that stops the drive from another thread.
    pub fn stopper(&self) -> impl Fn() + Send + 'static {
        let handle = self.link.handle();
        move || {
            handle.send(Request::Stop);
        }
    }
}

/// The link's thread; its simulated device is wired to `rig`, if there is one.
pub(super) fn wired(rig: Option<&PreparedRig>) -> std::io::Result<Worker> {
    let opener = rig.cloned().map_or_else(SystemOpener::default, |rig| {
        SystemOpener::wired(rig.device_options(), move || rig.inputs())
    });
    Worker::spawn_with(opener, || ())
}

impl<W: BlockingLink> Client<W> {
    /// A client on this link.
    pub const fn over(link: W) -> Self {
        Self {
            link,
            stops: AtomicU32::new(0),
            of_hold: Mutex::new(Vec::new()),
            stalls_before: AtomicU32::new(0),
            leases_before: AtomicU32::new(0),
        }
    }

    pub(super) const fn link(&self) -> &W {
        &self.link
    }

    /// Sends a request of a level hold; `awaits` returns whether the outcome of an earlier one is still needed.
    pub(super) fn send_of_hold(&self, request: Request, awaits: impl Fn(Ticket) -> bool) -> Ticket {
        let ticket = self.link.send_awaited(request);
        let mut sent = self.of_hold.lock().unwrap_or_else(PoisonError::into_inner);
        sent.push(ticket);
        sent.retain(|&of| {
            let is_needed = of == ticket || awaits(of);
            if !is_needed {
                self.link.release(of);
            }
            is_needed
        });
        ticket
    }

    /// Number of stops and disarms that calls have asked for until now. A wait compares it with that at its beginning: where it
    /// has changed, another thread has stopped the device.
    #[must_use]
    pub fn stops(&self) -> u32 {
        self.stops.load(Ordering::SeqCst)
    }

    fn count_stop(&self) {
        self.stops.fetch_add(1, Ordering::SeqCst);
    }

    /// Sends a request and waits for its outcome; `None` after `patience` or an interruption.
    fn outcome_of(&self, request: Request, patience: Duration) -> Option<Outcome> {
        let ticket = self.link.send_awaited(request);
        let outcome = self.link.wait(ticket, patience);
        self.link.release(ticket);
        outcome
    }

    /// Connects to a device. A lost link is not reconnected.
    ///
    /// # Errors
    /// [`ClientError::Refused`] and [`ClientError::NoAnswer`].
    pub fn connect(&self, port: &Port) -> Result<(), ClientError> {
        self.link.send(Request::AutoReconnect(false));
        match self.outcome_of(Request::Connect(port.clone()), CONNECTING) {
            Some(Outcome::Done { .. }) => Ok(()),
            Some(Outcome::Refused(refusal)) => Err(refusal.into()),
            _ => Err(self.interrupted_or(ClientError::NoAnswer(port.clone()))),
        }
    }

    /// Connects to a device that is observed only: nothing is armed without [`Client::arm`].
    ///
    /// # Errors
    /// As [`Client::connect`].
    pub fn observe(&self, port: &Port) -> Result<(), ClientError> {
        self.link.send(Request::Observe);
        self.connect(port)
    }

    /// The latest state of link and device.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        self.link.snapshot()
    }

    /// Signals that this program is alive, from a loop of the caller.
    pub fn sign_of_life(&self) {
        self.link.sign_of_life();
    }

    /// Sleeps, with signs of life.
    pub fn pause(&self, time: Duration) {
        self.link.pause(time);
    }

    /// Computes on another thread, while this one gives signs of life.
    ///
    /// # Errors
    /// [`ClientError::Thread`].
    pub fn during<R: Send>(&self, compute: impl FnOnce() -> R + Send) -> Result<R, ClientError> {
        thread::scope(|scope| {
            let (running, ended) = channel::<()>();
            let work = thread::Builder::new().spawn_scoped(scope, move || {
                let _running = running;
                compute()
            })?;
            self.sign_of_life();
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(GLANCE) {
                self.sign_of_life();
            }
            Ok(work.join().unwrap_or_else(|panic| resume_unwind(panic)))
        })
    }

    /// The identity of the device.
    ///
    /// # Errors
    /// [`ClientError::Mismatch`] where its firmware may not be driven, [`ClientError::Gone`].
    pub fn identity(&self) -> Result<Arc<Identity>, ClientError> {
        let snapshot = self.snapshot();
        match (&snapshot.device.identity, snapshot.device.compatibility) {
            (Some(identity), Some(compatibility)) if compatibility.may_drive() => Ok(identity.clone()),
            (_, Some(compatibility)) => Err(ClientError::Mismatch(compatibility)),
            (_, None) => Err(ClientError::Gone),
        }
    }

    /// Writes the profile of the board's actuator, or erases it.
    ///
    /// # Errors
    /// A request's error: refused unless the board's user button is held, pressed within the last 30 s.
    pub fn write_profile(&self, profile: Option<ActuatorProfile>) -> Result<(), ClientError> {
        self.perform(Request::WriteProfile(Box::new(profile))).map(drop)
    }

    /// Arms the device on a lease of [`LEASE`].
    ///
    /// # Errors
    /// A request's error: refused, lost, late, held up.
    pub fn arm(&self) -> Result<(), ClientError> {
        self.arm_for(Some(LEASE))
    }

    /// Arms the device on this lease, 1 to 600 s, or without one: the device disarms itself where no drive has begun for so long,
    /// and every later call fails with [`ClientError::LeaseOver`].
    ///
    /// # Errors
    /// A request's error: refused, lost, late, held up.
    pub fn arm_for(&self, lease: Option<Duration>) -> Result<(), ClientError> {
        self.attend();
        self.perform(lease.map_or(Request::Arm, Request::ArmFor)).map(drop)
    }

    /// From now on this program must not be held up ([`Client::check_attended`]).
    pub(super) fn attend(&self) {
        let snapshot = self.snapshot();
        self.stalls_before.store(snapshot.link.driver_stalls, Ordering::Relaxed);
        self.leases_before.store(snapshot.drive.leases_over, Ordering::Relaxed);
    }

    /// Disarms the device, and waits until its output has faded: the device can be armed in silence only.
    ///
    /// # Errors
    /// A request's error.
    pub fn disarm(&self) -> Result<(), ClientError> {
        self.count_stop();
        self.perform(Request::Disarm)?;
        self.await_silence()
    }

    /// Waits until a ramp of the output has ended.
    fn await_silence(&self) -> Result<(), ClientError> {
        for _ in 0..FADING {
            self.refresh()?;
            if self.snapshot().drive.status.is_some_and(|status| status.state != State::Stopping) {
                break;
            }
            self.pause(GLANCE);
        }
        Ok(())
    }

    /// Sends a stop and a disarm, without waiting.
    pub fn stop_and_disarm(&self) {
        self.count_stop();
        self.link.send(Request::Stop);
        self.link.send(Request::Disarm);
    }

    /// Stops and disarms the device, and closes its port. A device that does not answer any more stops by itself.
    pub fn disconnect(&self) {
        self.count_stop();
        let ticket = self.link.send_awaited(Request::Disconnect);
        // An interruption does not shorten it.
        while self.link.wait(ticket, CLOSING).is_none() && self.link.take_interruption() {}
        self.link.release(ticket);
    }

    /// Clears the faults whose causes are gone, and waits until the ramp of the stop has ended: the device can be armed in
    /// silence only.
    ///
    /// # Errors
    /// [`ClientError::Stopped`] with the faults whose causes stand, and a request's error.
    pub fn clear_faults(&self) -> Result<(), ClientError> {
        self.perform(Request::ClearFaults)?;
        self.await_silence()?;
        self.check_faults()
    }

    /// Uploads this table, unless the device holds it already.
    ///
    /// # Errors
    /// A request's error.
    pub fn use_table(&self, table: Arc<DeviceTable>) -> Result<(), ClientError> {
        self.perform(Request::Upload(table)).map(drop)
    }

    /// Starts a drive, chord or comb; returns the sample index at which it begins. A change that is to begin at an index ahead
    /// ([`Client::play_at`]) begins first: this waits for it.
    ///
    /// # Errors
    /// [`ClientError::Superseded`], those of [`Client::check_drives`] during that wait, and a request's error.
    pub fn play(&self, sounding: Sounding) -> Result<u64, ClientError> {
        self.await_change_ahead(|| true)?;
        self.perform_at(Request::Play(sounding))
    }

    /// Ramps to silence; returns the sample index at which the ramp begins.
    ///
    /// # Errors
    /// A request's error.
    pub fn stop(&self) -> Result<u64, ClientError> {
        self.count_stop();
        self.perform_at(Request::Stop)
    }

    /// Ramps to silence within 2 ms, mutes, and latches the fault
    /// [`EmergencyStop`](slipline_link::protocol::event::Fault::EmergencyStop); returns the sample index at which the ramp begins.
    ///
    /// # Errors
    /// A request's error.
    pub fn emergency_stop(&self) -> Result<u64, ClientError> {
        self.count_stop();
        self.perform_at(Request::EmergencyStop)
    }

    /// Requests the device's status; returns its sample index.
    ///
    /// # Errors
    /// A request's error.
    pub fn refresh(&self) -> Result<u64, ClientError> {
        self.perform_at(Request::Refresh)
    }

    /// Fails if a fault of the device is latched, by its latest status.
    ///
    /// # Errors
    /// [`ClientError::Stopped`].
    pub fn check_faults(&self) -> Result<(), ClientError> {
        let snapshot = self.snapshot();
        match snapshot.drive.status.filter(|status| !status.faults.is_empty()) {
            Some(status) => Err(ClientError::Stopped(StandingFaults {
                faults: status.faults,
                text: snapshot.faults_text(status.faults),
            })),
            None => Ok(()),
        }
    }

    /// Fails if the link has stopped and disarmed the device since it was armed, because this program was held up, if the device
    /// has disarmed itself at the end of its lease, or if the user has interrupted the call under way.
    ///
    /// # Errors
    /// [`ClientError::HeldUp`], [`ClientError::LeaseOver`] and [`ClientError::Interrupted`].
    pub fn check_attended(&self) -> Result<(), ClientError> {
        if self.link.take_interruption() {
            return Err(ClientError::Interrupted);
        }
        let snapshot = self.snapshot();
        if snapshot.link.driver_stalls != self.stalls_before.load(Ordering::Relaxed) {
            return Err(ClientError::HeldUp);
        }
        match snapshot.drive.lease_over {
            Some(lease) if snapshot.drive.leases_over != self.leases_before.load(Ordering::Relaxed) => {
                Err(ClientError::LeaseOver(lease))
            }
            _ => Ok(()),
        }
    }

    /// Sends a request and waits for its result.
    pub(super) fn perform(&self, request: Request) -> Result<Outcome, ClientError> {
        // After an interruption in a pause nothing more is begun.
        if self.link.take_interruption() {
            return Err(ClientError::Interrupted);
        }
        match self.outcome_of(request, PATIENCE) {
            Some(Outcome::Refused(refusal)) => {
                // A disarmed device refuses to be driven; the stall is the reason.
                self.check_attended()?;
                Err(refusal.into())
            }
            Some(Outcome::Superseded) => Err(ClientError::Superseded),
            Some(Outcome::DeviceTooOld) => Err(ClientError::Mismatch(Compatibility::DeviceOlder)),
            Some(Outcome::NotConnected) => {
                let error = self.snapshot().link.error.clone();
                Err(error.map_or(ClientError::Gone, ClientError::Lost))
            }
            Some(outcome) => Ok(outcome),
            None => Err(self.interrupted_or(ClientError::Late)),
        }
    }

    /// Why nothing came: an interruption, or this.
    fn interrupted_or(&self, error: ClientError) -> ClientError {
        if self.link.take_interruption() { ClientError::Interrupted } else { error }
    }

    /// Sends a request and returns the sample index at which its effect begins.
    fn perform_at(&self, request: Request) -> Result<u64, ClientError> {
        let Outcome::Done { at } = self.perform(request)? else { return Err(ClientError::Unexpected) };
        Ok(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_link::{SIGN_PATIENCE, SIGN_PERIOD};

    #[test]
    fn what_takes_longer_than_the_links_patience_is_computed_without_losing_the_device() {
        let client = Client::new(None).unwrap();
        client.connect(&Port::Simulated).unwrap();
        client.arm().unwrap();
        let computed = client.during(|| {
            thread::sleep(SIGN_PATIENCE + SIGN_PERIOD);
            7
        });
        assert_eq!(computed.unwrap(), 7);
        client.check_attended().unwrap();
    }
}
