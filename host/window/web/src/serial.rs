//! Boards by Web Serial: the ports that the browser lets this page open, and the bytes to and from the open one.
//!
//! ```text
//! link --open, write--> queues here --open, write, close--> glue in static/serial.js --> the browser
//!      <----read-------             <--opened, received, written, ended--
//! ```
//! The queues exist because a transport may not hold what belongs to the browser, and because the browser answers
//! later.

use slipline_link::transport::{Transport, read_received};
use slipline_link::{LinkError, Port, PortInfo, USB_PRODUCT, USB_VENDOR};
use std::io::{self, ErrorKind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use wasm_bindgen::prelude::wasm_bindgen;

/// The USB vendor id of the probe on ST's boards, behind which their UART is.
const STLINK_VENDOR: u32 = 0x0483;
/// Bytes that wait for the browser, at most.
const UNWRITTEN_MAX: usize = 4096;
/// Why a port does not open: the browser does not say which of these it is.
const NOT_OPENED: &str =
    "the browser could not open it. Another page or program has it, or, on Linux, the permission is missing";

#[wasm_bindgen]
extern "C" {
    /// The glue in `static/serial.js`. It answers by the methods of the device worker, never before these return.
    pub type SerialGlue;

    /// Opens the board of this id; its events come under the line's number.
    #[wasm_bindgen(method)]
    fn open(this: &SerialGlue, line: u32, id: u32);

    /// Writes bytes; then it says that they are written.
    #[wasm_bindgen(method)]
    fn write(this: &SerialGlue, line: u32, bytes: &[u8]);

    /// Closes a line.
    #[wasm_bindgen(method)]
    fn close(this: &SerialGlue, line: u32);
}

/// The boards; clones are the same ones.
#[derive(Clone, Default)]
pub(crate) struct Boards(Arc<Mutex<Queues>>);

#[derive(Default)]
struct Queues {
    /// The glue's ids of the boards that are plugged in, and their ports.
    listed: Vec<(u32, PortInfo)>,
    /// Whether the list has changed since it was taken.
    is_list_new: bool,
    /// The board that the user has just chosen.
    chosen: Option<Port>,
    /// The line that the link has.
    line: Option<Queue>,
    /// How many lines there were.
    lines: u32,
    /// Lines that the link has dropped.
    dropped: Vec<u32>,
}

/// The bytes of one line.
#[derive(Default)]
struct Queue {
    number: u32,
    /// The board to open, until the glue learns of it.
    unopened: Option<u32>,
    is_open: bool,
    received: Vec<u8>,
    unwritten: Vec<u8>,
    /// The glue has bytes that are not written yet.
    is_writing: bool,
    /// Why there is no more to read.
    end: Option<(ErrorKind, String)>,
}

impl Boards {
    fn lock(&self) -> MutexGuard<'_, Queues> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The boards that are plugged in and that this page may open.
    pub(crate) fn list(&self) -> Vec<PortInfo> {
        self.lock().listed.iter().map(|(_, info)| info.clone()).collect()
    }

    /// A line to a board, which the browser opens later.
    pub(crate) fn open(&self, port: &Port) -> Result<BoardLine, LinkError> {
        let mut queues = self.lock();
        let found = queues.listed.iter().find(|(_, info)| info.port == *port);
        let id = found.map(|(id, _)| *id).ok_or_else(|| LinkError::NoSuchPort(port.clone()))?;
        queues.lines += 1;
        let number = queues.lines;
        queues.line = Some(Queue { number, unopened: Some(id), ..Queue::default() });
        Ok(BoardLine { boards: self.clone(), number })
    }

    /// Passes on to the glue what the link wants.
    pub(crate) fn carry_out(&self, glue: &SerialGlue) {
        let mut queues = self.lock();
        for line in queues.dropped.drain(..) {
            glue.close(line);
        }
        let Some(queue) = &mut queues.line else { return };
        if let Some(id) = queue.unopened.take() {
            glue.open(queue.number, id);
        }
        if queue.is_open && !queue.is_writing && !queue.unwritten.is_empty() {
            queue.is_writing = true;
            glue.write(queue.number, &std::mem::take(&mut queue.unwritten));
        }
    }

    /// The ports, if their list has changed since the last call.
    pub(crate) fn take_list(&self) -> Option<Vec<PortInfo>> {
        let is_new = std::mem::take(&mut self.lock().is_list_new);
        is_new.then(|| self.list())
    }

    /// The board that the user has chosen since the last call.
    pub(crate) fn take_chosen(&self) -> Option<Port> {
        self.lock().chosen.take()
    }

    /// Takes the present boards: for each its id, its USB vendor and its USB product.
    pub(crate) fn listed(&self, boards: &[u32]) {
        let mut queues = self.lock();
        let before = std::mem::take(&mut queues.listed);
        let boards = boards.chunks_exact(3).filter_map(|board| <[u32; 3]>::try_from(board).ok());
        let mut listed: Vec<(u32, Option<PortInfo>, u32, u32)> = boards
            .map(|[id, vendor, product]| {
                let known = before.iter().find(|(known, _)| *known == id).map(|(_, info)| info.clone());
                (id, known, vendor, product)
            })
            .collect();
        // A board keeps its name while it is plugged in; another one gets the first name that is free.
        for place in 0..listed.len() {
            let Some(&(_, None, vendor, product)) = listed.get(place) else { continue };
            let is_free = |name: &str| {
                let mut known = listed.iter().filter_map(|(_, info, ..)| info.as_ref());
                known.all(|info| info.label != name)
            };
            let kind = kind(vendor, product);
            let numbered = (2..).map(|number| format!("{kind} {number}"));
            let name = std::iter::once(kind.clone()).chain(numbered).find(|name| is_free(name));
            if let (Some(name), Some(entry)) = (name, listed.get_mut(place)) {
                let is_ours = (vendor, product) == (USB_VENDOR.into(), USB_PRODUCT.into());
                let port = Port::Serial(name.clone());
                entry.1 = Some(PortInfo { port, label: name, is_ours, usb_serial: None });
            }
        }
        queues.listed = listed.into_iter().filter_map(|(id, info, ..)| Some((id, info?))).collect();
        queues.is_list_new |= queues.listed != before;
    }

    /// The user has chosen the board of this id.
    pub(crate) fn choose(&self, id: u32) {
        let mut queues = self.lock();
        let found = queues.listed.iter().find(|(listed, _)| *listed == id);
        queues.chosen = found.map(|(_, info)| info.port.clone());
    }

    /// Does this with a line, if the link still has it.
    fn with_line(&self, number: u32, act: impl FnOnce(&mut Queue)) {
        if let Some(queue) = self.lock().line.as_mut().filter(|queue| queue.number == number) {
            act(queue);
        }
    }

    /// A line is open.
    pub(crate) fn opened(&self, line: u32) {
        self.with_line(line, |queue| queue.is_open = true);
    }

    /// Bytes have come.
    pub(crate) fn received(&self, line: u32, bytes: &[u8]) {
        self.with_line(line, |queue| queue.received.extend_from_slice(bytes));
    }

    /// Notes that the glue has written all its bytes.
    pub(crate) fn written(&self, line: u32) {
        self.with_line(line, |queue| queue.is_writing = false);
    }

    /// A line could not be opened or has failed, with the name and the text of the browser's error; its text is shown only where
    /// it is the glue's own.
    pub(crate) fn ended(&self, line: u32, name: &str, text: &str) {
        self.with_line(line, |queue| {
            let end = match (queue.is_open, name) {
                (false, "TimeoutError") => (ErrorKind::Other, text.to_owned()),
                (false, _) => (ErrorKind::Other, NOT_OPENED.to_owned()),
                (true, "NetworkError") => {
                    (ErrorKind::BrokenPipe, "it was unplugged, or restarted".to_owned())
                }
                (true, _) => (ErrorKind::Other, format!("the browser ended its line ({name})")),
            };
            queue.end.get_or_insert(end);
        });
    }
}

/// The name of boards with these USB ids: the browser knows no product's name and gives no serial number.
fn kind(vendor: u32, product: u32) -> String {
    match (vendor, product) {
        _ if (vendor, product) == (USB_VENDOR.into(), USB_PRODUCT.into()) => "Slipline by USB".to_owned(),
        (STLINK_VENDOR, _) => "Board with ST-LINK".to_owned(),
        _ => format!("USB {vendor:04x}:{product:04x}"),
    }
}

/// A line to a board.
pub(crate) struct BoardLine {
    boards: Boards,
    number: u32,
}

impl BoardLine {
    /// Does this with the queue, unless another line has taken its place.
    fn with<T>(&self, act: impl FnOnce(&mut Queue) -> io::Result<T>) -> io::Result<T> {
        let mut queues = self.boards.lock();
        let queue = queues.line.as_mut().filter(|queue| queue.number == self.number);
        queue.map_or_else(|| Err(ErrorKind::NotConnected.into()), act)
    }
}

impl Transport for BoardLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.with(|queue| match &queue.end {
            Some((kind, text)) if queue.received.is_empty() => Err(io::Error::new(*kind, text.clone())),
            _ => read_received(&mut queue.received, buffer),
        })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.with(|queue| {
            let room = UNWRITTEN_MAX.saturating_sub(queue.unwritten.len());
            let count = bytes.len().min(room);
            if count == 0 {
                return Err(ErrorKind::WouldBlock.into());
            }
            queue.unwritten.extend(bytes.iter().take(count));
            Ok(count)
        })
    }

    fn is_open(&self) -> bool {
        self.with(|queue| Ok(queue.is_open)).unwrap_or(true)
    }
}

impl Drop for BoardLine {
    fn drop(&mut self) {
        let mut queues = self.boards.lock();
        if queues.line.as_ref().is_some_and(|queue| queue.number == self.number) {
            queues.line = None;
        }
        queues.dropped.push(self.number);
    }
}
