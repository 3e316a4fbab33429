//! Records a session of this build's host with this build's device, to standard output: once for each minor version,
//! when it is released. The files in `transcripts/` are never made again.

use slipline_protocol::version::{MAJOR, MINOR};
use slipline_tests::transcript::{Line, SessionRecorder, play};
use std::sync::{Arc, Mutex};

fn main() {
    let recorder = Arc::new(Mutex::new(SessionRecorder::default()));
    play(&recorder, MINOR, SessionRecorder::pass);
    println!("# A host and a device of protocol {MAJOR}.{MINOR}. Frozen: never edit this file.");
    for line in &recorder.lock().expect("nobody else holds it").lines {
        let hex = |frame: &[u8]| frame.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        match line {
            Line::Blocks(blocks) => println!("+ {blocks}"),
            Line::Host(frame) => println!("> {}", hex(frame)),
            Line::Device(frame) => println!("< {}", hex(frame)),
        }
    }
}
