//! Answers browsers: GET and HEAD of the page's files.

use super::super::failure::Failure;
use super::contents::Contents;
use slipline_model::atomic_file::said;
use std::fmt::Display;
use std::io::{Cursor, Read};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};

/// Answers at once: a browser that reads slowly keeps the others from none of these.
const ANSWERS: usize = 4;
/// Threads of the server itself: one that accepts, and those that read requests.
const SERVING: usize = 5;
/// Digits of the hash in the name of a file that never changes; `.ci/page-assemble` writes it.
const HASH_DIGITS: usize = 16;

/// A server of this computer.
pub(super) struct PageServer {
    server: Arc<Server>,
    is_ended: Arc<AtomicBool>,
    at: SocketAddr,
}

/// By which another thread ends the server.
pub(super) struct Ending {
    server: Arc<Server>,
    is_ended: Arc<AtomicBool>,
}

impl Ending {
    pub(super) fn end(&self) {
        self.is_ended.store(true, Ordering::Relaxed);
        // One of the waiting threads each.
        for _ in 0..ANSWERS {
            self.server.unblock();
        }
    }
}

impl PageServer {
    /// Takes the address.
    pub(super) fn bind(at: SocketAddr) -> Result<Self, Failure> {
        let refused = |why: &dyn Display| Failure::Failed(format!("--listen {at}: {}", said(why)));
        can_start(SERVING + ANSWERS).map_err(|error| Failure::Failed(said(&error)))?;
        let server = Server::http(at).map_err(|why| refused(&why))?;
        let at = server.server_addr().to_ip().ok_or_else(|| refused(&"no address of the network"))?;
        Ok(Self { server: Arc::new(server), is_ended: Arc::default(), at })
    }

    /// Where a browser finds it.
    pub(super) fn address(&self) -> String {
        format!("http://{}/", self.at)
    }

    pub(super) fn ending(&self) -> Ending {
        Ending { server: Arc::clone(&self.server), is_ended: Arc::clone(&self.is_ended) }
    }

    /// Answers until it is ended.
    pub(super) fn serve(&self, contents: &Contents) {
        let answer = || {
            while !self.is_ended.load(Ordering::Relaxed) {
                // An error is the end's call, or a connection that failed: then the next one is waited for.
                if let Ok(request) = self.server.recv() {
                    respond(request, contents);
                }
            }
        };
        thread::scope(|scope| {
            // This thread answers, too: with fewer threads than wanted some wait longer.
            for _ in 1..ANSWERS {
                let _ = thread::Builder::new().spawn_scoped(scope, answer);
            }
            answer();
        });
    }
}

/// Whether the system runs this many more threads at once: the server itself fails without a word where it does not.
fn can_start(count: usize) -> std::io::Result<()> {
    let gate = Mutex::new(());
    thread::scope(|scope| {
        let _shut = gate.lock();
        let wait = || drop(gate.lock());
        (0..count).try_for_each(|_| thread::Builder::new().spawn_scoped(scope, wait).map(drop))
    })
}

/// Answers one request.
fn respond(request: Request, contents: &Contents) {
    let answer = if matches!(request.method(), Method::Get | Method::Head) {
        file(request.url(), contents, takes_packed(request.headers()))
    } else {
        plain(405, "GET and HEAD are answered.\n", "Allow: GET, HEAD")
    };
    // The browser may have closed the connection; the answer is then dropped.
    let _ = request.respond(answer);
}

type Answer = Response<Box<dyn Read + Send>>;

/// Whether a browser takes files as `gzip` packs them (RFC 9110, 12.5.3).
fn takes_packed(headers: &[Header]) -> bool {
    let accepted = headers.iter().filter(|header| header.field.equiv("Accept-Encoding"));
    let mut codings = accepted.flat_map(|header| header.value.as_str().split(','));
    codings.any(|coding| {
        let mut parts = coding.split(';').map(str::trim);
        let is_refused = |part: &str| {
            part.strip_prefix("q=")
                .is_some_and(|weight| weight.parse::<f32>().is_ok_and(|weight| weight <= 0.0))
        };
        parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip")) && !parts.any(is_refused)
    })
}

fn file(address: &str, contents: &Contents, takes_packed: bool) -> Answer {
    let found = Contents::named(address).and_then(|name| {
        let packed = if takes_packed { contents.read_packed(&name) } else { None };
        let is_packed = packed.is_some();
        Some((packed.or_else(|| contents.read(&name))?, is_packed, name))
    });
    let Some((bytes, is_packed, name)) = found else {
        return plain(404, "The page has no such file.\n", "Cache-Control: no-store");
    };
    let encoding = is_packed.then(|| "Content-Encoding: gzip".to_owned());
    let headers = [
        "Vary: Accept-Encoding".to_owned(),
        format!("Content-Type: {}", content_type(&name)),
        format!(
            "Cache-Control: {}",
            if has_hash(&name) { "public, max-age=31536000, immutable" } else { "no-cache" }
        ),
    ];
    let length = bytes.len();
    answer(200, headers.iter().chain(&encoding).map(String::as_str), Box::new(Cursor::new(bytes)), length)
}

/// A line of text, with one more header.
fn plain(code: u16, text: &'static str, header: &str) -> Answer {
    answer(
        code,
        ["Content-Type: text/plain; charset=utf-8", header].into_iter(),
        Box::new(text.as_bytes()),
        text.len(),
    )
}

fn answer<'a>(
    code: u16,
    headers: impl Iterator<Item = &'a str>,
    bytes: Box<dyn Read + Send>,
    length: usize,
) -> Answer {
    // A line that is no header is none of those above.
    let headers =
        headers.chain(["X-Content-Type-Options: nosniff"]).filter_map(|line| line.parse::<Header>().ok());
    // With its length, however long it is.
    Response::new(StatusCode(code), headers.collect(), bytes, Some(length), None)
        .with_chunked_threshold(usize::MAX)
}

/// A browser runs a module, or compiles what arrives, only by its right type.
fn content_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "webmanifest") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("ttf") => "font/ttf",
        Some("woff2") => "font/woff2",
        Some("txt" | "toml") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

/// Whether a file's name holds the hash of its content, so that a browser need never ask for it again.
fn has_hash(name: &str) -> bool {
    let is_hash = |part: &str| part.len() == HASH_DIGITS && part.bytes().all(|byte| byte.is_ascii_hexdigit());
    name.rsplit('.').nth(1).is_some_and(is_hash)
}
