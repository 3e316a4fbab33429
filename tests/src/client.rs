//! The interface of every test client, for a simulated or an emulated device.

use slipline_protocol::event::{Event, Status};
use slipline_protocol::units::SampleIndex;
use slipline_protocol::{Command, Refusal};

/// Sends a command and returns what the answer of this kind carries; any other answer is a panic.
#[macro_export]
macro_rules! answer {
    ($client:expr, $command:expr, $kind:ident) => {
        match $client.send(&$command) {
            ::slipline_protocol::event::Event::$kind(carried) => carried,
            other => panic!("{other:?}"),
        }
    };
}

/// A client of the protocol with a device that answers.
pub trait Client {
    /// Sends a command and returns the answer.
    ///
    /// # Panics
    /// If there is none.
    fn send(&mut self, command: &Command) -> Event;

    /// Sends a command that must be accepted and returns the sample index of the reply.
    ///
    /// # Panics
    /// If it is not.
    fn accepted(&mut self, command: &Command) -> SampleIndex {
        let answer = self.send(command);
        answer.accepted_at().unwrap_or_else(|| panic!("{command:?} should be accepted, not {answer:?}"))
    }

    /// Sends a command that must be refused and returns the refusal.
    ///
    /// # Panics
    /// If it is not.
    fn refused(&mut self, command: &Command) -> Refusal {
        match self.send(command) {
            Event::Refused(refusal) => refusal,
            other => panic!("{command:?} should be refused, not {other:?}"),
        }
    }

    /// Asks for the status.
    ///
    /// # Panics
    /// If another reply comes.
    fn status(&mut self) -> Status {
        match self.send(&Command::Status) {
            Event::Status(status) => status,
            other => panic!("a status should come, not {other:?}"),
        }
    }
}
