//! What a user asks of an installed program: which one it is, its images, its manual, and what permits a port.

use super::{failure, file, json, said, says};
use slipline_link::udev;

#[test]
fn the_version_as_json_says_how_the_program_was_installed() {
    let value = json(&["--version"]);
    assert_eq!(value["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(value["installed"], "source");
    assert_eq!(
        value["program"],
        std::fs::canonicalize(env!("CARGO_BIN_EXE_slipline")).unwrap().to_str().unwrap()
    );
    let text = said(&["--version"]);
    match value["commit"].as_str() {
        Some(commit) => says(&text, &[&format!("({commit})")]),
        None => assert!(!text.contains('('), "{text}"),
    }
}

#[test]
fn the_rules_of_udev_are_printed_as_they_are_installed() {
    assert_eq!(said(&["udev"]), udev::RULES);
    let value = json(&["udev"]);
    assert_eq!(value["rules"], udev::RULES);
    let lines: Vec<_> = udev::install_lines().collect();
    assert_eq!(value["install_lines"], serde_json::json!(lines));
}

#[test]
fn a_program_without_images_says_who_has_them() {
    assert!(said(&["images"]).contains("releases have them"));
    let folder = file("images-of-none");
    let why = failure(&["images", "--out", folder.to_str().unwrap()], 2);
    assert!(why.contains("releases have them") && why.contains(".ci/images"), "{why}");
    assert!(!folder.exists());
}

#[test]
fn each_command_has_a_page_of_the_manual_which_is_not_replaced_unasked() {
    let folder = file("manual");
    let _ = std::fs::remove_dir_all(&folder);
    let out = folder.to_str().unwrap();
    let value = json(&["manual", "--out", out]);
    let files = value["files"].as_array().unwrap();
    assert!(files.len() > 20, "{files:?}");
    let page = std::fs::read_to_string(folder.join("slipline-drive.1")).unwrap();
    assert!(page.contains(".TH SLIPLINE-DRIVE 1") && page.contains("felt\\-edge"), "{page}");
    assert!(failure(&["manual", "--out", out], 2).contains("--force"));
    std::fs::remove_dir_all(folder).unwrap();
}
