//! What the fuzzer has found interesting, replayed..

use slipline_tests::fuzz;
use std::path::Path;

fn replay(target: &str, run: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).expect("the corpus is there") {
        let path = entry.expect("a file of the corpus").path();
        println!("{}", path.display());
        run(&std::fs::read(&path).expect("a file of the corpus"));
        count += 1;
    }
    assert!(count >= 8, "the corpus of {target} has {count} files");
}

#[test]
fn noise_on_the_link_changes_no_state_and_does_not_feed_the_dead_man() {
    replay("rx_bytes", fuzz::rx_bytes);
}

#[test]
fn a_message_that_can_be_decoded_is_encoded_to_the_same_message() {
    replay("decode", fuzz::decode);
}

#[test]
fn after_any_session_a_silent_host_leaves_a_silent_device() {
    replay("session", fuzz::session);
}

#[test]
fn a_plate_file_is_an_error_or_a_plate() {
    replay("load_plate", fuzz::load_plate);
}
