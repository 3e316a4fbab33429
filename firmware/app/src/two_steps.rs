//! How a host ends the program, for the ROM bootloader or by a fault on purpose: it asks for a token, then sends it back.

use slipline_protocol::frame::CRC;
use slipline_protocol::refusal::Refusal;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::SampleIndex;

/// The two steps of one such order. The controller checks the state that it needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct TwoSteps {
    token: Option<(u32, SampleIndex)>,
    tokens_given: u32,
    leaving_since: Option<SampleIndex>,
}

impl TwoSteps {
    /// Gives a token; one given before is no longer valid.
    pub fn give_token(&mut self, unit: &[u8; 12], now: SampleIndex) -> u32 {
        self.tokens_given = self.tokens_given.wrapping_add(1);
        // Not a secret: it only has to differ from what noise or an old session could show.
        let mut crc = CRC.digest();
        crc.update(unit);
        crc.update(&now.to_le_bytes());
        crc.update(&self.tokens_given.to_le_bytes());
        let token = crc.finalize();
        self.token = Some((token, now));
        token
    }

    /// Takes a token back. The one given is used up, whatever was shown.
    ///
    /// # Errors
    /// [`Refusal::BadToken`] if it is not the one given, or too old.
    pub fn show_token(&mut self, token: u32, now: SampleIndex, timing: &Timing) -> Result<(), Refusal> {
        let valid = self
            .token
            .take()
            .is_some_and(|(given, at)| given == token && now.saturating_sub(at) < timing.bootloader_token);
        if !valid {
            return Err(Refusal::BadToken);
        }
        self.leaving_since = Some(now);
        Ok(())
    }

    /// Whether it is time to end the program, true once: two transmit time-outs after the token, so that the reply goes out first.
    pub fn is_passed(&mut self, now: SampleIndex, timing: &Timing) -> bool {
        let passed =
            self.leaving_since.is_some_and(|at| now.saturating_sub(at) >= timing.transmit.saturating_mul(2));
        if passed {
            self.leaving_since = None;
        }
        passed
    }

    /// Forgets the token, and that it was shown.
    pub fn close(&mut self) {
        self.token = None;
        self.leaving_since = None;
    }
}
