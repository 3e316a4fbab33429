//! From the last byte of a command to the first changed sample.

use slipline_protocol::Command;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, Rig, drive};

#[test]
fn a_drive_shows_within_two_blocks_of_its_last_byte_and_exactly_where_the_reply_says() {
    let mut rig = Rig::armed();
    rig.record();
    let sent_at = rig.device.now();
    let at = rig.play(&[(0, 0.5, 1.0)], 2000, 10);
    assert!(at - sent_at <= 2 * BLOCK, "{} samples", at - sent_at);
    // From silence the level rises with a raised cosine: the first sample above half a code comes some samples later
    // than `at`, never before.
    let first = rig.recording.first_sound(sent_at).expect("the drive sounds");
    assert!(first >= at && first - at <= BLOCK, "{first} for {at}");
}

#[test]
fn a_drag_changes_the_samples_from_the_index_in_the_reply_on_and_not_before() {
    let mut moved = Rig::armed();
    let mut left = Rig::armed();
    for rig in [&mut moved, &mut left] {
        rig.play(&[(0, 0.5, 0.9)], 2000, 40);
        rig.record();
    }
    let sent_at = moved.device.now();
    let at = moved.accepted(&Command::Drive(drive(&[(0, 0.9, 0.9)], 2000)));
    moved.live_ms(5);
    left.live_ms(5);
    let first = moved
        .recording
        .codes
        .iter()
        .zip(&left.recording.codes)
        .position(|(a, b)| a != b)
        .map(|i| sent_at + i as u64)
        .expect("the drag changes the samples");
    assert!(at - sent_at <= 2 * BLOCK && first - sent_at <= 2 * BLOCK, "{at} {first} for {sent_at}");
    // The phase runs ahead from `at` on: a code differs within some samples.
    assert!(first >= at && first - at < BLOCK, "{first} for {at}");
}
