//! The emulated device: the image of `firmware/qemu` in QEMU, with a small synchronous host on its serial line.
//!
//! ```text
//! Host --Unix socket--> QEMU [ UART0 -> application -> DAC -> UART1 ] --Unix socket--> Emulator::shown
//! ```
//! Time is real here, as on a board: on an idle computer about as fast as the wall clock, otherwise slower, never
//! faster. Comparisons are therefore made by sample index, not by time.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command as Process, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use slipline_app::BLOCK;
use slipline_protocol::Decoder;
use slipline_protocol::command::{Command, Hello, KeepAlive};
use slipline_protocol::event::Event;
use slipline_protocol::limits::KEEP_ALIVE_PERIOD_MS;
use slipline_protocol::units::SampleIndex;
use slipline_protocol::version::{Minor, Version};

use crate::client::Client;
use crate::programs::image;
use crate::rig::Table;

/// An answer that takes longer counts as missing, however slow the machine.
const REPLY_TIMEOUT: Duration = Duration::from_secs(30);

/// How the emulated UART0 is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// A Unix domain socket.
    Socket,
    /// A pseudo-terminal, which looks like a board's serial port.
    Terminal,
}

/// A block that the DAC has played: the index of its first code, and its codes.
type Block = (SampleIndex, [u16; BLOCK]);

/// A running emulator; dropping it ends it.
pub struct Emulator {
    process: Child,
    link: PathBuf,
    asking: UnixStream,
    blocks: Receiver<Block>,
    /// What the emulator has sent of the block that is not whole yet.
    begun: Arc<Mutex<Vec<u8>>>,
    folder: PathBuf,
    /// Keeps the pseudo-terminal open while no host does.
    _terminal: Option<File>,
}

impl Emulator {
    /// Starts the emulator with the image.
    ///
    /// # Panics
    /// If QEMU is not installed or does not start.
    #[must_use]
    pub fn start(line: Line) -> Self {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("slipline-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
        let (link, codes) = (folder.join("link"), folder.join("codes"));
        let socket = |path: &Path| format!("unix:{},server=on,wait=off", path.display());
        let mut process = Process::new("qemu-system-arm")
            .args([
                "-M",
                "mps2-an386",
                "-display",
                "none",
                "-monitor",
                "none",
                "-icount",
                "shift=0",
                "-serial",
            ])
            .arg(match line {
                Line::Socket => socket(&link),
                Line::Terminal => "pty".to_owned(),
            })
            .args(["-serial", &socket(&codes), "-kernel"])
            .arg(image())
            .stdout(Stdio::piped())
            .spawn()
            .expect("qemu-system-arm is installed");
        let link = match line {
            Line::Socket => link,
            Line::Terminal => terminal_of(&mut process),
        };
        let terminal = (line == Line::Terminal).then(|| {
            let open =
                File::options().read(true).write(true).open(&link).expect("the terminal can be opened");
            // QEMU looks once a second whether somebody has opened it; a board's port exists at once.
            std::thread::sleep(Duration::from_millis(1500));
            open
        });
        let asking = connect(&codes);
        let begun = Arc::default();
        let blocks = read_blocks(asking.try_clone().expect("a socket can be shared"), Arc::clone(&begun));
        Self { process, link, asking, blocks, begun, folder, _terminal: terminal }
    }

    /// Where the link's other end is.
    #[must_use]
    pub fn link(&self) -> &Path {
        &self.link
    }

    /// A host on the link.
    #[must_use]
    pub fn host(&self) -> Host {
        Host::new(connect(&self.link))
    }

    /// Asks for the next blocks that the DAC plays, without waiting for them; at most 255.
    ///
    /// # Panics
    /// If the emulator has ended.
    pub fn ask(&mut self, blocks: u8) {
        self.asking.write_all(&[blocks]).expect("the emulator runs");
    }

    /// Waits for blocks asked for.
    ///
    /// # Panics
    /// If they do not come. Instead of a block there may be the message of the image's panic: it is shown.
    pub fn shown(&mut self, blocks: usize) -> Vec<Block> {
        let next = |number| {
            self.blocks.recv_timeout(REPLY_TIMEOUT).unwrap_or_else(|error| {
                let begun = self.begun.lock().expect("no thread panics while it holds it").clone();
                panic!("block {number} of {blocks}: {error}, after {:?}", String::from_utf8_lossy(&begun));
            })
        };
        (0..blocks).map(next).collect()
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // Both may fail only if there is nothing left to end or to remove.
        let _ended = self.process.kill().and_then(|()| self.process.wait());
        let _removed = std::fs::remove_dir_all(&self.folder);
    }
}

/// Reads the blocks as they come, in a thread of its own. A socket holds a few hundred of the emulator's single bytes;
/// when it is full, the renderer waits for a reader, and below the renderer nothing runs: no command would be answered.
fn read_blocks(mut codes: UnixStream, begun: Arc<Mutex<Vec<u8>>>) -> Receiver<Block> {
    let (send, blocks) = mpsc::channel();
    // A test asks for blocks when it likes.
    codes.set_read_timeout(None).expect("a time-out can be taken away");
    std::thread::spawn(move || {
        let mut bytes = [0; 8 + 2 * BLOCK];
        // Until the emulator or the test has ended.
        while let Ok(count @ 1..) = codes.read(&mut bytes) {
            let mut begun = begun.lock().expect("no thread panics while it holds it");
            begun.extend_from_slice(&bytes[..count]);
            let Some((whole, _)) = begun.split_first_chunk::<{ 8 + 2 * BLOCK }>() else { continue };
            let (index, codes) = whole.split_first_chunk().expect("a block is longer than its index");
            let mut block = [0; BLOCK];
            for (code, pair) in block.iter_mut().zip(codes.chunks_exact(2)) {
                *code = u16::from_le_bytes([pair[0], pair[1]]);
            }
            if send.send((SampleIndex::from_le_bytes(*index), block)).is_err() {
                break;
            }
            begun.drain(..bytes.len());
        }
    });
    blocks
}

/// QEMU names the terminal it has opened on its standard output.
fn terminal_of(process: &mut Child) -> PathBuf {
    let output = process.stdout.take().expect("its output is piped");
    let line = BufReader::new(output)
        .lines()
        .map_while(Result::ok)
        .find(|line| line.contains("/dev/"))
        .expect("QEMU names its terminal");
    let start = line.find("/dev/").unwrap_or(0);
    PathBuf::from(line[start..].split_whitespace().next().unwrap_or_default())
}

/// Connects as soon as the emulator listens.
fn connect(path: &Path) -> UnixStream {
    let deadline = Instant::now() + REPLY_TIMEOUT;
    loop {
        match UnixStream::connect(path) {
            Ok(stream) => {
                stream.set_read_timeout(Some(REPLY_TIMEOUT)).expect("a time-out can be set");
                return stream;
            }
            Err(error) => assert!(Instant::now() < deadline, "the emulator does not listen: {error}"),
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A host that says one thing at a time and waits for the answer.
pub struct Host {
    line: UnixStream,
    decoder: Decoder,
    session: u32,
    sequence: u16,
    beat: u32,
    beat_due: Instant,
}

impl Host {
    fn new(line: UnixStream) -> Self {
        Self { line, decoder: Decoder::new(), session: 0, sequence: 0, beat: 0, beat_due: Instant::now() }
    }

    /// Begins a session.
    ///
    /// # Panics
    /// If the device does not answer it.
    pub fn hello(&mut self) {
        let hello = Command::Hello(Hello { version: Version::OURS, nonce: *b"test" });
        self.say(&hello, 0, 0);
        let (session, event) = self.answer();
        assert!(matches!(event, Event::Hello(_)), "a hello is answered by an identity, not {event:?}");
        self.session = session;
    }

    fn say(&mut self, command: &Command, session: u32, sequence: u16) {
        let frame = command.frame_for(Minor::OURS, session, sequence).expect("a command fits a frame");
        self.line.write_all(&frame).expect("the emulator runs");
    }

    fn answer(&mut self) -> (u32, Event) {
        let mut byte = [0];
        loop {
            match self.line.read(&mut byte) {
                Ok(1..) => {}
                Ok(_) => panic!("the emulator has ended"),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => panic!("no answer: {error}"),
            }
            let event = self.decoder.push(byte[0], |frame| {
                (
                    frame.header.session,
                    Event::decode(frame.header.id, frame.body).expect("events can be read"),
                )
            });
            if let Some(event) = event {
                return event;
            }
        }
    }

    /// Uploads a table and swaps it in; returns the index of the swap.
    pub fn upload(&mut self, table: &Table) -> SampleIndex {
        self.accepted(&Command::TableBegin(table.header));
        for chunk in table.chunks() {
            self.accepted(&Command::TableChunk(chunk));
        }
        self.accepted(&Command::TableCommit)
    }

    /// Lives until the device has come to an index.
    ///
    /// # Panics
    /// If it does not get there.
    pub fn live_until(&mut self, index: SampleIndex) {
        let deadline = Instant::now() + REPLY_TIMEOUT;
        loop {
            self.keep_alive_if_due();
            if self.status().now >= index {
                return;
            }
            assert!(Instant::now() < deadline, "the emulated device does not get there");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Sends a keep-alive if the last one is old enough.
    pub fn keep_alive_if_due(&mut self) {
        if Instant::now() >= self.beat_due {
            self.beat_due = Instant::now() + Duration::from_millis(KEEP_ALIVE_PERIOD_MS.into());
            self.beat += 1;
            self.send(&Command::KeepAlive(KeepAlive { beat: self.beat }));
        }
    }
}

impl Client for Host {
    fn send(&mut self, command: &Command) -> Event {
        if command.is_sequenced() {
            self.sequence = self.sequence.wrapping_add(1);
        }
        self.say(command, self.session, self.sequence);
        self.answer().1
    }
}
