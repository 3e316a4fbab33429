//! `slipline page`: a browser gets the page's files, and nothing else.

use super::serving::Serving;
use super::{failure, file, refused};
use serde_json::Value;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder of a page, beside a file that is not of it.
fn built(name: &str) -> PathBuf {
    let outside = file(name);
    let folder = outside.join("target/page");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("../secret.txt"), "not of the page").unwrap();
    for (name, bytes) in [
        ("index.html", &b"<title>Slipline</title>"[..]),
        ("sw.js", b"// worker"),
        ("page.0123456789abcdef.js", b"import"),
        ("slipline_page_bg.0123456789abcdef.wasm", b"\0asm"),
        ("slipline_page_bg.0123456789abcdef.wasm.gz", b"packed"),
    ] {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    outside
}

/// Serves a page from this folder.
fn start(folder: &Path, arguments: &[&str]) -> Serving {
    Serving::start(folder, &[&["page", "--listen", "127.0.0.1:0"], arguments].concat())
}

impl Serving {
    /// Its address without scheme and slash.
    fn host(&self) -> &str {
        self.1["address"].as_str().unwrap().strip_prefix("http://").unwrap().strip_suffix('/').unwrap()
    }

    /// The answer's head and body, to a request that is sent as it is.
    fn answer(&self, method: &str, address: &str) -> (String, Vec<u8>) {
        let mut stream = TcpStream::connect(self.host()).unwrap();
        write!(stream, "{method} {address} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.host())
            .unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
        let body = bytes.split_off(end + 4);
        (String::from_utf8(bytes).unwrap().to_lowercase(), body)
    }
}

#[test]
fn a_browser_gets_the_files_with_their_types_and_keeps_those_that_never_change() {
    let outside = built("page-types");
    let serving = start(&outside, &["--folder", "target/page"]);
    assert_eq!(serving.1["folder"], "target/page");
    let kept = "cache-control: public, max-age=31536000, immutable\r\n";
    for (address, kind, cache, body) in [
        ("/", "text/html; charset=utf-8", "cache-control: no-cache\r\n", &b"<title>Slipline</title>"[..]),
        (
            "/index.html?new",
            "text/html; charset=utf-8",
            "cache-control: no-cache\r\n",
            b"<title>Slipline</title>",
        ),
        ("/sw.js", "text/javascript; charset=utf-8", "cache-control: no-cache\r\n", b"// worker"),
        ("/page.0123456789abcdef.js", "text/javascript; charset=utf-8", kept, b"import"),
        ("/slipline_page_bg.0123456789abcdef.wasm", "application/wasm", kept, b"\0asm"),
    ] {
        let (head, got) = serving.answer("GET", address);
        assert!(head.starts_with("http/1.1 200 "), "{address}: {head}");
        assert!(
            head.contains(&format!("content-type: {kind}\r\n")) && head.contains(cache),
            "{address}: {head}"
        );
        assert!(head.contains(&format!("content-length: {}\r\n", body.len())), "{address}: {head}");
        assert_eq!(got, body, "{address}");
        let (of_head, nothing) = serving.answer("HEAD", address);
        assert!(
            of_head.starts_with("http/1.1 200 ") && of_head.contains(&format!("content-type: {kind}\r\n")),
            "{of_head}"
        );
        assert_eq!(nothing, b"", "{address}");
    }
    drop(serving);
    std::fs::remove_dir_all(outside).unwrap();
}

#[test]
fn a_browser_that_takes_gzip_gets_a_file_that_is_built_packed() {
    let outside = built("page-packed");
    let serving = start(&outside, &["--folder", "target/page"]);
    let wasm = "/slipline_page_bg.0123456789abcdef.wasm";
    let encoding = "content-encoding: gzip\r\n";
    for accepted in ["gzip", "br;q=1.0, GZIP;q=0.5", "deflate, gzip"] {
        let (head, body) =
            serving.answer("GET", &format!("{wasm} HTTP/1.1\r\nAccept-Encoding: {accepted}\r\nX:"));
        assert!(
            head.contains(encoding) && head.contains("content-type: application/wasm\r\n"),
            "{accepted}: {head}"
        );
        assert_eq!(body, b"packed", "{accepted}");
    }
    for (address, accepted) in [(wasm, "gzip;q=0"), (wasm, "br, x-gzip"), ("/sw.js", "gzip")] {
        let (head, body) =
            serving.answer("GET", &format!("{address} HTTP/1.1\r\nAccept-Encoding: {accepted}\r\nX:"));
        assert!(!head.contains(encoding) && body != b"packed", "{address}, {accepted}: {head}");
    }
}

#[test]
fn a_file_with_a_packed_copy_alone_is_unpacked_for_a_browser_that_does_not_take_it() {
    let outside = built("page-unpacked");
    // By `printf import | gzip -9 -n`. A program holds each file once.
    let packed =
        b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\xcb\xcc-\xc8/*\x01\x00\x1d\xceN\x9d\x06\x00\x00\x00";
    std::fs::write(outside.join("target/page/alone.js.gz"), packed).unwrap();
    let serving = start(&outside, &["--folder", "target/page"]);
    for (accepted, expected) in [("gzip", &packed[..]), ("identity", b"import")] {
        let (head, body) =
            serving.answer("GET", &format!("/alone.js HTTP/1.1\r\nAccept-Encoding: {accepted}\r\nX:"));
        assert!(head.starts_with("http/1.1 200 ") && body == expected, "{accepted}: {head}");
    }
}

/// A connection that stays open keeps a thread of the server, of which there are few.
#[test]
fn a_browser_is_asked_to_close_each_connection() {
    let outside = built("page-close");
    let serving = start(&outside, &["--folder", "target/page"]);
    let mut stream = TcpStream::connect(serving.host()).unwrap();
    write!(stream, "GET / HTTP/1.1\r\nHost: {}\r\nConnection: keep-alive\r\n\r\n", serving.host()).unwrap();
    let mut bytes = Vec::new();
    let mut part = [0; 512];
    while !bytes.ends_with(b"</title>") {
        let count = stream.read(&mut part).unwrap();
        assert!(count > 0, "the answer is whole");
        bytes.extend_from_slice(&part[..count]);
    }
    assert!(String::from_utf8(bytes).unwrap().contains("Connection: close\r\n"));
    drop(stream);
    drop(serving);
    std::fs::remove_dir_all(outside).unwrap();
}

#[test]
fn nothing_else_is_answered() {
    let outside = built("page-else");
    let serving = start(&outside, &["--folder", "target/page"]);
    for address in [
        "/nothing.js",
        "/../secret.txt",
        "/fonts/../../secret.txt",
        "/%2e%2e/secret.txt",
        "/..%2fsecret.txt",
        "//etc/passwd",
        "/.",
    ] {
        let (head, body) = serving.answer("GET", address);
        assert!(head.starts_with("http/1.1 404 "), "{address}: {head}");
        assert_eq!(body, b"The page has no such file.\n", "{address}");
    }
    for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
        let (head, _) = serving.answer(method, "/");
        assert!(
            head.starts_with("http/1.1 405 ") && head.contains("allow: get, head\r\n"),
            "{method}: {head}"
        );
    }
    drop(serving);
    std::fs::remove_dir_all(outside).unwrap();
}

#[test]
fn without_the_option_the_page_that_was_built_here_is_served_and_a_signal_ends_it_with_0() {
    let outside = built("page-default");
    for option in ["-INT", "-TERM"] {
        let serving = start(&outside, &[]);
        // A program with the page in it has its own.
        let folder = if cfg!(feature = "page") { Value::Null } else { "target/page".into() };
        assert_eq!(serving.1["folder"], folder);
        // A connection that is open does not hold it.
        let _open = TcpStream::connect(serving.host()).unwrap();
        let (head, _) = serving.answer("GET", "/");
        assert!(head.starts_with("http/1.1 200 "), "{head}");
        assert_eq!(serving.end(option).code(), Some(0), "{option}");
    }
    std::fs::remove_dir_all(outside).unwrap();
}

#[test]
fn an_address_that_other_computers_reach_is_refused() {
    for listen in [
        "0.0.0.0:8765",
        "192.168.1.2:80",
        "[::]:8765",
        "[2001:db8::1]:80",
        "localhost:80",
        "127.0.0.1",
        "8765",
    ] {
        let message = failure(&["page", "--listen", listen], 2);
        let allowed = "must be an address that only this computer reaches, 127.0.0.0 to 127.255.255.255 or [::1], and a port";
        assert!(message.contains("'--listen <ADDRESS>'") && message.contains(allowed), "{message}");
    }
}

#[test]
fn a_folder_without_a_page_and_an_address_that_is_taken_are_refused() {
    let outside = built("page-refused");
    let folder = outside.join("target");
    refused(
        &["page", "--folder", folder.to_str().unwrap()],
        2,
        &["'--folder <FOLDER>': must be a folder with a built page"],
    );
    if cfg!(not(feature = "page")) {
        let output =
            Command::new(env!("CARGO_BIN_EXE_slipline")).arg("page").current_dir(&folder).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("build it by .ci/page") && message.contains("--folder"), "{message}");
    }
    let serving = start(&outside, &["--folder", "target/page"]);
    let page = outside.join("target/page");
    let message = failure(&["page", "--folder", page.to_str().unwrap(), "--listen", serving.host()], 1);
    assert!(message.contains(&format!("--listen {}", serving.host())), "{message}");
    drop(serving);
    std::fs::remove_dir_all(outside).unwrap();
}
