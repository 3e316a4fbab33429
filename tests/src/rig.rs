//! A test rig: a simulated device with a small synchronous client, in virtual time.

use slipline_link::simulator::{Options, SentBlock, SimulatedDevice};
use slipline_protocol::command::{
    Apply, Chord, ChordTone, Comb, CombTone, Command, Drive, Hello, KeepAlive, TableChunk, TableHeader, Tone,
};
use slipline_protocol::event::Event;
use slipline_protocol::limits::{CHUNK_KNOTS, KEEP_ALIVE_PERIOD_MS};
use slipline_protocol::table::{self, Knot};
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position, SampleIndex};
use slipline_protocol::version::{Minor, Version};
use slipline_protocol::{Decoder, Direction, Header};

use crate::client::Client;

/// Samples in a block, as a number of samples of a run.
pub const BLOCK: u64 = slipline_link::BLOCK as u64;
/// Mid-scale.
pub const MID: u16 = 2048;
/// The default sample rate of a rig, in Hz.
pub const RATE_HZ: u32 = 400_000;

/// A reply as it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Reply {
    /// Its header.
    pub header: Header,
    /// Its body.
    pub event: Event,
}

/// A table with its header.
#[derive(Clone, Debug)]
pub struct Table {
    /// What `TableBegin` says.
    pub header: TableHeader,
    /// The knots.
    pub knots: Vec<Knot>,
}

impl Table {
    /// Frequencies on a line from `first_hz` to `last_hz`, gains by `gain(share of the span)`, 0..=1.
    #[must_use]
    pub fn line(knots: u16, first_hz: f64, last_hz: f64, gain: impl Fn(f64) -> f64) -> Self {
        Self::of(
            (0..knots)
                .map(|i| {
                    let u = f64::from(i) / f64::from(knots - 1);
                    let turns = (first_hz + u * (last_hz - first_hz)) / f64::from(RATE_HZ);
                    Knot {
                        step: (turns * 4_294_967_296.0).round() as u32,
                        gain: Gain((gain(u) * f64::from(Gain::FULL.0)).round().max(1.0) as u32),
                    }
                })
                .collect(),
        )
    }

    /// These knots over 80..270 mm.
    #[must_use]
    pub fn of(knots: Vec<Knot>) -> Self {
        let mut header = TableHeader {
            knots: knots.len() as u16,
            span_start_um: 80_000,
            span_end_um: 270_000,
            sample_rate_hz: RATE_HZ,
            crc: 0,
        };
        header.crc = table::digest(
            header.span_start_um,
            header.span_end_um,
            header.sample_rate_hz,
            header.knots,
            |index| knots[usize::from(index)],
        );
        Self { header, knots }
    }

    /// The same phase steps for a device at another rate: every frequency is proportional to it.
    #[must_use]
    pub fn at_rate(mut self, sample_rate_hz: u32) -> Self {
        let header = &mut self.header;
        header.sample_rate_hz = sample_rate_hz;
        header.crc =
            table::digest(header.span_start_um, header.span_end_um, sample_rate_hz, header.knots, |index| {
                self.knots[usize::from(index)]
            });
        self
    }

    /// The usual one: 60 kHz down to 20 kHz, gain 0.5 rising to 1.
    #[must_use]
    pub fn usual() -> Self {
        Self::line(257, 60_000.0, 20_000.0, |u| 0.5 + 0.5 * u)
    }

    /// The upload's chunks.
    pub fn chunks(&self) -> impl Iterator<Item = TableChunk> + '_ {
        self.knots.chunks(CHUNK_KNOTS).enumerate().map(|(i, knots)| TableChunk {
            first: (i * CHUNK_KNOTS) as u16,
            knots: heapless::Vec::from_slice(knots).expect("a chunk's knots fit a chunk"),
        })
    }
}

/// A drive of these tones: slot, position 0..=1, level 0..=1.
#[must_use]
pub fn drive(tones: &[(u8, f64, f64)], glide: u32) -> Drive {
    Drive {
        tones: tones.iter().map(|&(slot, position, level)| tone(slot, position, level)).collect(),
        master: CentiDecibel(0),
        glide,
        apply: Apply::Next,
    }
}

/// A chord of these tones: multiple of the base frequency `rate / 2^period_log2`, level 0..=1, phase in turns.
#[must_use]
pub fn chord(period_log2: u8, tones: &[(u16, f64, f64)]) -> Chord {
    let tone = |&(harmonic, level, turns): &(u16, f64, f64)| ChordTone {
        harmonic,
        level: Level((level * 65_535.0).round() as u16),
        phase: Phase((turns.rem_euclid(1.0) * 65_536.0) as u16),
    };
    Chord {
        period_log2,
        tones: tones.iter().map(tone).collect(),
        master: CentiDecibel(0),
        glide: 2000,
        apply: Apply::Next,
    }
}

/// A comb of these tones: multiple of the base frequency `rate / (128 period_blocks)`, level 0..=1, phase in turns.
#[must_use]
pub fn comb(period_blocks: u16, tones: &[(u16, f64, f64)]) -> Comb {
    let tone = |&(harmonic, level, turns): &(u16, f64, f64)| CombTone {
        harmonic,
        level: Level((level * 65_535.0).round() as u16),
        phase: Phase((turns.rem_euclid(1.0) * 65_536.0) as u16),
    };
    Comb {
        period_blocks,
        tones: tones.iter().map(tone).collect(),
        master: CentiDecibel(0),
        glide: 2000,
        apply: Apply::Next,
    }
}

/// One tone.
#[must_use]
pub fn tone(slot: u8, position: f64, level: f64) -> Tone {
    Tone {
        slot,
        position: Position((position * 65_535.0).round() as u16),
        level: Level((level * 65_535.0).round() as u16),
        phase: Phase(0),
    }
}

/// The codes that were sent to the DAC.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// The index of the first code.
    pub first: SampleIndex,
    /// The codes.
    pub codes: Vec<u16>,
    /// Whether the amplifier was muted, by block.
    pub muted: Vec<bool>,
}

impl Recording {
    /// The codes from an index on.
    #[must_use]
    pub fn from(&self, index: SampleIndex) -> &[u16] {
        &self.codes[(index - self.first) as usize..]
    }

    /// The index of the first code that is not mid-scale, at or after `from`.
    #[must_use]
    pub fn first_sound(&self, from: SampleIndex) -> Option<SampleIndex> {
        self.from(from).iter().position(|&code| code != MID).map(|i| from + i as u64)
    }

    /// The index after the last code that is not mid-scale.
    #[must_use]
    pub fn end_of_sound(&self) -> Option<SampleIndex> {
        self.codes.iter().rposition(|&code| code != MID).map(|i| self.first + i as u64 + 1)
    }

    /// Whether the amplifier was muted while the code at an index left.
    #[must_use]
    pub fn was_muted(&self, index: SampleIndex) -> bool {
        self.muted[((index - self.first) / BLOCK) as usize]
    }
}

/// A simulated device and the client that talks to it.
pub struct Rig {
    /// The device.
    pub device: SimulatedDevice,
    /// What was sent to the DAC since the recording was last begun.
    pub recording: Recording,
    session: u32,
    sequence: u16,
    beat: u32,
    beat_due: SampleIndex,
    nonce: u32,
    decoder: Decoder,
    /// Replies that were not waited for.
    pub replies: Vec<Reply>,
}

impl Default for Rig {
    fn default() -> Self {
        Self::new(Options::default())
    }
}

impl Rig {
    /// A device just started.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self::of(SimulatedDevice::new(options))
    }

    /// A client that has not connected to this device yet.
    #[must_use]
    pub fn of(device: SimulatedDevice) -> Self {
        Self {
            recording: Recording { first: device.now(), ..Recording::default() },
            device,
            session: 0,
            sequence: 0,
            beat: 0,
            beat_due: 0,
            nonce: 0,
            decoder: Decoder::new(),
            replies: Vec::new(),
        }
    }

    /// A device with the usual table, armed and unmuted.
    #[must_use]
    pub fn armed() -> Self {
        Self::armed_with(&Table::usual())
    }

    /// A device with a table, armed and unmuted.
    #[must_use]
    pub fn armed_with(table: &Table) -> Self {
        let mut rig = Self::default();
        rig.hello();
        rig.upload(table);
        rig.arm();
        rig
    }

    /// An armed device that drives these tones, with this glide, for so long.
    #[must_use]
    pub fn driving(tones: &[(u8, f64, f64)], glide: u32, milliseconds: u32) -> Self {
        let mut rig = Self::armed();
        rig.play(tones, glide, milliseconds);
        rig
    }

    /// A device just started that has answered a hello.
    #[must_use]
    pub fn greeted() -> Self {
        Self::greeted_with(Options::default())
    }

    /// The same with a device of these options.
    #[must_use]
    pub fn greeted_with(options: Options) -> Self {
        let mut rig = Self::new(options);
        rig.hello();
        rig
    }

    /// Says hello, uploads the usual table and arms.
    pub fn make_ready(&mut self) {
        self.hello();
        self.upload(&Table::usual());
        self.arm();
    }

    /// Drives these tones, and lets time pass; returns the index of the reply.
    pub fn play(&mut self, tones: &[(u8, f64, f64)], glide: u32, milliseconds: u32) -> SampleIndex {
        let at = self.accepted(&Command::Drive(drive(tones, glide)));
        self.live_ms(milliseconds);
        at
    }

    /// Arms, keeps alive, and lets the amplifier unmute.
    pub fn arm(&mut self) {
        self.accepted(&Command::Arm);
        self.keep_alive();
        self.live_ms(10);
    }

    /// Begins a new session.
    pub fn hello(&mut self) -> Reply {
        self.nonce += 1;
        self.hello_as(Version::OURS)
    }

    /// Begins a new session as a host of this minor version.
    pub fn hello_of_minor(&mut self, minor: u8) -> Reply {
        self.nonce += 1;
        self.hello_as(Version { minor, ..Version::OURS })
    }

    /// Says hello as a host of some version, with the nonce of the last hello.
    pub fn hello_as(&mut self, version: Version) -> Reply {
        let hello = Command::Hello(Hello { version, nonce: self.nonce.to_le_bytes() });
        let reply = self
            .exchange(&hello.frame_for(Minor::OURS, 0, 0).expect("a hello fits a frame"))
            .expect("a hello is answered");
        if reply.header.session != self.session {
            self.session = reply.header.session;
            self.sequence = 0;
            self.beat = 0;
        }
        reply
    }

    /// The number of the session.
    #[must_use]
    pub const fn session(&self) -> u32 {
        self.session
    }

    /// The number of the last numbered command.
    #[must_use]
    pub const fn sequence(&self) -> u16 {
        self.sequence
    }

    /// The number of the last keep-alive.
    #[must_use]
    pub const fn beat(&self) -> u32 {
        self.beat
    }

    /// The next command's bytes; a numbered command takes the next number.
    #[must_use]
    pub fn frame(&mut self, command: &Command) -> Vec<u8> {
        if command.is_sequenced() {
            self.sequence = self.sequence.wrapping_add(1);
        }
        self.frame_as(command, self.session, self.sequence)
    }

    /// A command's bytes with any header.
    #[must_use]
    pub fn frame_as(&self, command: &Command, session: u32, sequence: u16) -> Vec<u8> {
        command.frame_for(Minor::OURS, session, sequence).expect("a command fits a frame").to_vec()
    }

    /// Feeds bytes and returns the last reply to them.
    pub fn exchange(&mut self, bytes: &[u8]) -> Option<Reply> {
        self.device.feed(bytes);
        self.collect();
        self.replies.pop()
    }

    /// Decodes what the device has sent into `replies`.
    pub fn collect(&mut self) {
        let mut bytes = Vec::new();
        self.device.take(&mut bytes);
        for byte in bytes {
            let reply = self.decoder.push(byte, |frame| {
                assert_eq!(frame.header.direction, Direction::ToHost);
                let event =
                    Event::decode(frame.header.id, frame.body).expect("the device's events can be read");
                Reply { header: frame.header, event }
            });
            self.replies.extend(reply);
        }
    }

    /// Sends the next keep-alive.
    pub fn keep_alive(&mut self) -> Option<Reply> {
        self.beat += 1;
        let bytes = self.frame(&Command::KeepAlive(KeepAlive { beat: self.beat }));
        self.beat_due = self.device.now() + self.samples(KEEP_ALIVE_PERIOD_MS);
        self.exchange(&bytes)
    }

    /// Uploads a table and commits it; returns the index of the swap.
    pub fn upload(&mut self, table: &Table) -> SampleIndex {
        self.stage(table);
        let at = self.accepted(&Command::TableCommit);
        self.live_blocks(2);
        at
    }

    /// Uploads a table up to the commit.
    pub fn stage(&mut self, table: &Table) {
        self.accepted(&Command::TableBegin(table.header));
        for chunk in table.chunks() {
            self.accepted(&Command::TableChunk(chunk));
        }
    }

    /// A time in samples.
    #[must_use]
    pub fn samples(&self, milliseconds: u32) -> u64 {
        u64::from(milliseconds) * u64::from(self.device.sample_rate_hz()) / 1000
    }

    /// Lets blocks pass while the client sends nothing, and records them.
    pub fn silent_blocks(&mut self, blocks: u64) {
        let recording = &mut self.recording;
        self.device.advance(blocks, |SentBlock { codes, muted, .. }| {
            recording.codes.extend_from_slice(codes);
            recording.muted.push(muted);
        });
    }

    /// Lets time pass while the client sends nothing.
    pub fn silent_ms(&mut self, milliseconds: u32) {
        self.silent_blocks(self.samples(milliseconds).div_ceil(BLOCK));
    }

    /// Lets blocks pass while the client sends its keep-alives.
    pub fn live_blocks(&mut self, mut blocks: u64) {
        while blocks > 0 {
            if self.session != 0 && self.device.now() >= self.beat_due {
                self.keep_alive();
            }
            let step = blocks.min(16);
            self.silent_blocks(step);
            blocks -= step;
        }
    }

    /// Lets time pass while the client sends its keep-alives.
    pub fn live_ms(&mut self, milliseconds: u32) {
        self.live_blocks(self.samples(milliseconds).div_ceil(BLOCK));
    }

    /// Begins a new recording.
    pub fn record(&mut self) {
        self.recording = Recording { first: self.device.now(), ..Recording::default() };
    }
}

impl Client for Rig {
    fn send(&mut self, command: &Command) -> Event {
        let bytes = self.frame(command);
        self.exchange(&bytes).unwrap_or_else(|| panic!("{command:?} is answered")).event
    }
}
