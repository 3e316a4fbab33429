//! Answers browsers: GET and HEAD of the page's files.

use super::super::failure::Failure;
use super::contents::Contents;
use slipline_model::atomic_file::said;
use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, Write};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use tiny_http::{Header, Method, Request, Server};

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

/// Answers one request, and has the browser close the connection: each that stays open keeps a thread of tiny_http's, which
/// starts too few where several arrive at once. A browser with six of them waited for its last file for ever.
fn respond(request: Request, contents: &Contents) {
    let answer = if matches!(request.method(), Method::Get | Method::Head) {
        file(request.url(), contents, takes_packed(request.headers()))
    } else {
        plain("405 Method Not Allowed", "GET and HEAD are answered.\n", "Allow: GET, HEAD")
    };
    let has_body = !matches!(request.method(), Method::Head);
    // The browser may have closed the connection; the answer is then dropped.
    let _ = answer.write(&mut request.into_writer(), has_body);
}

/// An answer to a browser.
struct Answer {
    /// Its number and words.
    status: &'static str,
    headers: Vec<String>,
    bytes: Cow<'static, [u8]>,
}

impl Answer {
    fn write(&self, browser: &mut dyn Write, has_body: bool) -> io::Result<()> {
        let Self { status, headers, bytes } = self;
        let mut head = format!("HTTP/1.1 {status}\r\n");
        let length = format!("Content-Length: {}", bytes.len());
        let always = ["X-Content-Type-Options: nosniff", "Connection: close", &length];
        for header in headers.iter().map(String::as_str).chain(always) {
            head.push_str(header);
            head.push_str("\r\n");
        }
        head.push_str("\r\n");
        browser.write_all(head.as_bytes())?;
        if has_body {
            browser.write_all(bytes)?;
        }
        browser.flush()
    }
}

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
        return plain("404 Not Found", "The page has no such file.\n", "Cache-Control: no-store");
    };
    let kept = if has_hash(&name) { "public, max-age=31536000, immutable" } else { "no-cache" };
    let mut headers = vec![
        "Vary: Accept-Encoding".to_owned(),
        format!("Content-Type: {}", content_type(&name)),
        format!("Cache-Control: {kept}"),
    ];
    headers.extend(is_packed.then(|| "Content-Encoding: gzip".to_owned()));
    Answer { status: "200 OK", headers, bytes }
}

/// A line of text, with one more header.
fn plain(status: &'static str, text: &'static str, header: &str) -> Answer {
    let headers = vec!["Content-Type: text/plain; charset=utf-8".to_owned(), header.to_owned()];
    Answer { status, headers, bytes: Cow::Borrowed(text.as_bytes()) }
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
