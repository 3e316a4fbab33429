//! The corpora of the fuzzers, replayed..

use slipline_tests::fuzz::TARGETS;
use slipline_tests::source_tree::root;
use std::collections::BTreeSet;
use std::fs;

fn names(folder: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder of the fuzzer");
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

fn replay(target: &str) {
    let (_, run) = TARGETS.iter().find(|(name, _)| *name == target).expect("a target");
    let folder = root().join("tests/corpus").join(target);
    let mut count = 0;
    for entry in fs::read_dir(&folder).expect("the corpus exists") {
        let path = entry.expect("a file of the corpus").path();
        println!("{}", path.display());
        run(&fs::read(&path).expect("a file of the corpus"));
        count += 1;
    }
    assert!(count >= 8, "the corpus of {target} has {count} files");
}

#[test]
fn every_target_has_its_binary_its_corpus_and_its_replay() {
    let expected: BTreeSet<String> = TARGETS.iter().map(|(name, _)| (*name).to_owned()).collect();
    let binaries: BTreeSet<String> = names("tests/fuzz").iter().map(|name| name.replace(".rs", "")).collect();
    assert_eq!(binaries, expected);
    assert_eq!(names("tests/corpus"), expected);
    let manifest = fs::read_to_string(root().join("tests/Cargo.toml")).expect("the manifest");
    let source = include_str!("fuzz_corpora.rs");
    for name in expected {
        assert!(manifest.contains(&format!("path = \"fuzz/{name}.rs\"")), "{name}");
        assert!(source.contains(&format!("replay(\"{name}\")")), "{name}");
    }
}

#[test]
fn noise_on_the_link_changes_no_state_and_does_not_feed_the_dead_man() {
    replay("rx_bytes");
}

#[test]
fn a_message_that_can_be_decoded_is_encoded_to_the_same_message() {
    replay("decode");
}

#[test]
fn after_any_session_a_silent_host_leaves_a_silent_device() {
    replay("session");
}

#[test]
fn whatever_a_user_drives_matches_the_mirror_and_never_clips() {
    replay("program");
}

#[test]
fn measurements_match_the_sampled_inputs_despite_interruptions() {
    replay("inputs");
}

#[test]
fn a_device_starts_with_any_flash_and_drives_only_what_is_whole() {
    replay("stored");
}

#[test]
fn the_hosts_link_recovers_from_whatever_came_over_the_line() {
    replay("connection");
}

#[test]
fn a_plate_file_is_an_error_or_a_plate() {
    replay("load_plate");
}

#[test]
fn a_setup_file_is_an_error_or_a_setup_that_is_written_as_it_was_read() {
    replay("load_setup");
}

#[test]
fn a_measurement_is_an_error_or_rows_that_a_report_counts() {
    replay("load_measurement");
}
