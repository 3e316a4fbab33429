"""Sends a marker of the Lab Streaming Layer at the onset of each trial: python lsl_markers.py [FOLDER]

Needs ``pip install pylsl`` and the library liblsl. The marker is a JSON text with the trial's type and its sample index; its time
is that of the onset on LSL's clock, by the device's clock read between two readings of LSL's.
"""

import json
import sys

import pylsl
import slipline

info = pylsl.StreamInfo("Slipline", "Markers", 1, pylsl.IRREGULAR_RATE, pylsl.cf_string, "slipline-trials")
markers = pylsl.StreamOutlet(info)
trials = [{"turning_point_m": place_m, "duration_s": 0.1, "trial_type": f"{1e3 * place_m:.0f} mm"} for place_m in (0.12, 0.16, 0.2)]

with slipline.connect("sim") as device:

    def respond(trial):
        before_s = pylsl.local_clock()
        status = device.status()
        now_s = (before_s + pylsl.local_clock()) / 2
        onset_s = now_s - (status.now_samples - trial["at_samples"]) / status.sample_rate_hz
        text = json.dumps({"trial_type": trial["trial_type"], "at_samples": trial["at_samples"]})
        markers.push_sample([text], onset_s)

    device.use(slipline.Plate("membrane"))
    device.arm()
    folder = sys.argv[1] if sys.argv[1:] else "study"
    rows = slipline.trials.run(device, trials, respond, folder=folder, subject="01", task="markers")
print(f"{len(rows)} markers sent")
