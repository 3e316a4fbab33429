//! A target on the host's side of the link.

use std::io::ErrorKind;
use std::sync::Arc;

use slipline_link::DeviceTable;
use slipline_link::{LinkState, Outcome, Port, Request};
use slipline_protocol::command::DigestWindow;
use slipline_protocol::frame::{Direction, Header, encode};

use crate::faulty_ports::{as_real, board};
use crate::link_rig::{LinkRig, drive};

/// The rate of the device: low, so that time costs little.
const RATE_HZ: u32 = 40_000;
/// The longest that the link may take to find the device again when everything works.
const RECOVERY_MS: u64 = 5000;

/// The host's link under faults: each step is one byte that chooses the event, then its arguments. Among the device's
/// answers come bytes of any kind and whole frames with any body, the line fails, the cable is pulled, and the user makes
/// requests. Afterwards everything works again: the link connects, and stops the drive.
///
/// # Panics
/// If that does not hold.
pub fn connection(data: &[u8]) {
    let mut rig = LinkRig::armed_at(RATE_HZ);
    let mut bytes = data.iter().copied();
    for _ in 0..100 {
        let Some(step) = bytes.next() else { break };
        let mut byte = || bytes.next().unwrap_or(0);
        match step % 24 {
            0..4 => rig.pass_ms(u64::from(byte())),
            4 | 5 => {
                let count = usize::from(byte() % 64);
                let noise: Vec<u8> = (0..count).map(|_| byte()).collect();
                rig.ports().injected.extend(noise);
            }
            6..9 => {
                let (id, count) = (byte(), usize::from(byte() % 96));
                let body: Vec<u8> = (0..count).map(|_| byte()).collect();
                inject(&mut rig, id, &body);
            }
            9 => rig.ports().drop_replies = u32::from(byte() % 8),
            10 => rig.ports().drop_commands = u32::from(byte() % 8),
            11 => rig.ports().error = error(byte()),
            12 => rig.ports().unplug(),
            13 => rig.ports().listed = vec![board("A")],
            14 => rig.ports().stall(step & 1 == 1 && byte() % 2 == 0),
            _ => {
                let request = request(step % 24, byte(), &rig);
                rig.ask(request);
            }
        }
    }
    {
        let mut ports = rig.ports();
        ports.stall(false);
        ports.injected.clear();
        (ports.error, ports.rewrite, ports.listed) = (None, as_real, vec![board("A")]);
        (ports.drop_replies, ports.drop_commands, ports.drop_stops) = (0, 0, 0);
        if ports.device.is_in_bootloader() {
            return;
        }
    }
    rig.ask_and_pass(Request::Disconnect, RECOVERY_MS);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), RECOVERY_MS);
    assert_eq!(rig.view().link.state, LinkState::Connected);
    let stop = rig.ask(Request::Stop);
    rig.pass_ms(500);
    assert!(matches!(rig.outcome(stop), Some(Outcome::Done { .. })), "{:?}", rig.outcome(stop));
}

/// Puts a whole frame on the line, as if the device had answered the host's last command so.
fn inject(rig: &mut LinkRig, id: u8, body: &[u8]) {
    let mut ports = rig.ports();
    let Some(asked) = ports.last else { return };
    let header = Header { direction: Direction::ToHost, id: id | 0x80, ..asked };
    let frame = encode(header, |buffer| {
        buffer[..body.len()].copy_from_slice(body);
        Ok(body.len())
    });
    ports.injected.extend_from_slice(&frame.expect("a short body fits"));
}

fn error(byte: u8) -> Option<ErrorKind> {
    match byte % 6 {
        0 => Some(ErrorKind::BrokenPipe),
        1 => Some(ErrorKind::UnexpectedEof),
        2 => Some(ErrorKind::PermissionDenied),
        3 => Some(ErrorKind::WouldBlock),
        4 => Some(ErrorKind::TimedOut),
        _ => None,
    }
}

fn request(step: u8, byte: u8, rig: &LinkRig) -> Request {
    let share = f64::from(byte) / 255.0;
    match step {
        15 => Request::Connect(Port::Serial("A".to_owned())),
        16 => Request::Arm,
        17 => drive(0.1 * share),
        18 => [Request::Stop, Request::EmergencyStop, Request::ClearFaults, Request::Disarm]
            [usize::from(byte % 4)]
        .clone(),
        19 => {
            let knots = (0..50).map(|i| (100.0 + share + f64::from(i), 0.5));
            let table = DeviceTable::from_knots((0.0, 0.1), f64::from(RATE_HZ), knots, 1e-6);
            Request::Upload(Arc::new(table.expect("a plain table")))
        }
        20 => {
            let from = rig.ports().device.now() + u64::from(byte) * 100;
            Request::Digest(DigestWindow { from, count: 1 + u32::from(byte) * 16 })
        }
        21 => [Request::ReadBack, Request::Store, Request::Forget, Request::CancelUpload]
            [usize::from(byte % 4)]
        .clone(),
        22 => Request::AutoReconnect(byte.is_multiple_of(2)),
        _ => [Request::Disconnect, Request::Refresh, Request::Bootloader, Request::Refresh]
            [usize::from(byte % 4)]
        .clone(),
    }
}
