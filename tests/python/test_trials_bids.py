"""What trials write beside the validator of BIDS, which the step `python_types` installs."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from slipline import trials
from slipline.staircase import Staircase
from trial_device import device, run  # noqa: F401

VALIDATOR = shutil.which("bids-validator-deno") or shutil.which("bids-validator-deno", path=str(Path(sys.executable).parent))

#: The warnings that remain, which host/python/README.md names: what only a person knows.
FOR_THE_EXPERIMENTER = {
    *("README_FILE_MISSING", "TOO_FEW_AUTHORS", "Authors", "License", "SourceDatasets", "HEDVersion"),
    *("Instructions", "TaskDescription", "CogAtlasID", "CogPOID"),
    *("InstitutionName", "InstitutionAddress", "InstitutionalDepartmentName"),
}


@pytest.mark.skipif(VALIDATOR is None, reason="no bids-validator-deno here")
def test_the_validator_of_bids_finds_no_error(device, tmp_path):
    folder = tmp_path / "study"
    place = {"turning_point_m": 0.12, "duration_s": 0.5}
    listed = [
        {**place, "trial_type": "near", "hand": "left", "block": 1},
        {**place, "tones": [{"felt_edge_m": 0.21}], "timeout_s": 1.0, "block": 1},
        {"felt_edge_m": 0.21, "level": 0, "trial_type": "catch", "block": 2},
        {"intervals": [place, {**place, "level": 0}], "hand": "right", "block": 2},
    ]
    answers = [True, 3, None, {"response": "a text with \"quotes\"", "sure": 0.5}, False]
    more = {"seed": 1, "practice": listed[:1], "take_break": lambda trial: None}

    def leaves(trial):
        if trial["number"] == 2:
            raise KeyboardInterrupt
        return answers[trial["number"]]

    with pytest.raises(KeyboardInterrupt):
        run(device(), listed, leaves, folder, **more)
    # A second half, after the device was reset.
    assert len(run(device(started_s=60.0), listed, lambda trial: answers[trial["number"]], folder, **more)) == 5
    pair = trials.interleaved(*(Staircase(0.2, 0.25, trials=2, staircase=name) for name in ("a", "b")))
    run(device(), pair, lambda trial: trial["felt_edge_m"] > 0.23, folder, subject="02", session="b", task="two", run=1)
    done = subprocess.run([VALIDATOR, "--format", "json", str(folder)], capture_output=True, text=True)
    issues = json.loads(done.stdout)["issues"]["issues"]
    assert issues and not [issue for issue in issues if issue["severity"] == "error"]
    assert {issue.get("subCode") or issue["code"] for issue in issues} == FOR_THE_EXPERIMENTER
    # It does find what is wrong.
    path = next(folder.rglob("*task-edge_events.tsv"))
    path.write_text(path.read_text().replace("catch", "sudden"))
    done = subprocess.run([VALIDATOR, "--format", "json", str(folder)], capture_output=True, text=True)
    assert "error" in [issue["severity"] for issue in json.loads(done.stdout)["issues"]["issues"]]
