//! The gate's last line: the tests of all its runners, the red ones among them; and its steps in GitHub's workflows.
#![cfg(unix)]

use slipline_tests::source_tree::root;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

/// The last line for a log of the gate.
fn counted(log: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("gate-{}.log", std::process::id()));
    std::fs::write(&path, log).expect("a file");
    let output = Command::new("bash").arg(".ci/run").arg("--count").arg(&path).current_dir(root()).output();
    std::fs::remove_file(path).expect("it exists");
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

/// The steps of the gate, then those with a star, which it leaves to a night.
fn listed() -> [Vec<String>; 2] {
    let output = Command::new("bash").args([".ci/run", "--list"]).current_dir(root()).output();
    let list = String::from_utf8(output.expect("bash runs").stdout).expect("text");
    let words = list.lines().map(|line| line.split_whitespace().take(2).collect::<Vec<_>>());
    let (night, gate): (Vec<_>, Vec<_>) = words.partition(|words| words.last() == Some(&"*"));
    [gate, night].map(|steps| steps.iter().map(|words| words[0].to_owned()).collect())
}

/// The steps that a workflow runs: the words of its lines `chosen:`. Of a night in parts, `nightly 2/6`, the first part.
fn chosen(workflow: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(".github/workflows").join(workflow)).expect("a workflow");
    assert!(text.contains(".ci/run tools ${{ matrix.chosen }}"), "{workflow} runs what it has chosen");
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix("chosen: "));
    let jobs = lines.flat_map(|line| line.trim_matches(['[', ']']).split(", "));
    let first_parts = jobs.filter(|job| job.split_once(" 1/").is_some() || !job.contains('/'));
    first_parts
        .flat_map(str::split_whitespace)
        .filter(|word| !word.contains('/'))
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_workflows_run_each_step_once() {
    let [mut gate, night] = listed();
    gate.retain(|step| step != "tools");
    for (workflow, steps) in [("gate.yml", gate), ("night.yml", night)] {
        let chosen = chosen(workflow);
        let each: BTreeSet<_> = chosen.iter().collect();
        assert_eq!(each.len(), chosen.len(), "{workflow} runs a step twice: {chosen:?}");
        assert_eq!(each, steps.iter().collect(), "the steps of {workflow}, and those of .ci/run");
    }
}
