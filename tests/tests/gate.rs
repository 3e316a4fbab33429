//! The gate's last line: the tests of all its runners, the red ones among them.
#![cfg(unix)]

use slipline_tests::source_tree::root;
use std::path::PathBuf;
use std::process::Command;

/// The last line for a log of the gate.
fn counted(log: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("gate-{}.log", std::process::id()));
    std::fs::write(&path, log).expect("a file");
    let output = Command::new("bash").arg(".ci/run").arg("--count").arg(&path).current_dir(root()).output();
    std::fs::remove_file(path).expect("it is there");
    String::from_utf8(output.expect("bash runs").stdout).expect("text")
}

#[test]
fn the_tests_of_each_runner_are_counted_and_a_red_one_as_failed() {
    let cargo = "test result: ok. 9 passed; 0 failed; 3 ignored; 0 measured; 2 filtered out; finished in 0.15s\n\
                 test result: FAILED. 5 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n";
    let pytest = "128 passed, 283 deselected in 101.20s (0:01:41)\n\
                  ======= 1 failed, 20 passed, 2 skipped, 1 error in 3.02s =======\n";
    let unittest = "Ran 7 tests in 1.02s\n\nOK (skipped=1)\n\
                    Ran 10 tests in 0.10s\n\nFAILED (failures=1, errors=2, skipped=1)\n";
    assert_eq!(counted(cargo), "14 passed, 1 failed, 3 ignored\n");
    assert_eq!(counted(pytest), "148 passed, 2 failed, 2 ignored\n");
    assert_eq!(counted(unittest), "12 passed, 3 failed, 2 ignored\n");
    let all = [cargo, pytest, unittest].concat();
    assert_eq!(counted(&all), "174 passed, 6 failed, 7 ignored\n");
    assert_eq!(counted("running 3 tests\nno line of a runner\n"), "0 passed, 0 failed, 0 ignored\n");
}
