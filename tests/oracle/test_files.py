"""Files of the program in the readers of others (pandas, pyuff, ezdxf, soundfile), and the files of others in the program's.

The environment's SLIPLINE names the program.
"""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import ezdxf
import numpy as np
import pandas
import pyuff
import soundfile

PROGRAM = os.environ.get("SLIPLINE", "target/debug/slipline")
MEASURED = ["--port", "sim", "--plate", "al-bending", "--actual-plate", "secret:5"]
PLACES = [0.034, 0.187]


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.stderr}")
    return done.stdout


def table(path, **options):
    return pandas.read_csv(path, comment="#", **options)


def close(found, wanted, share=1e-12):
    return np.all(np.abs(np.asarray(found) - np.asarray(wanted)) <= share * np.abs(np.asarray(wanted)))


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.csv = [cls.folder / f"{name}.csv" for name in ("near", "far")]
        for path, place_m in zip(cls.csv, PLACES):
            run("measure", *MEASURED, "--sensor", f"{1e3 * place_m}mm", "--out", path)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_every_table_has_the_columns_of_its_head(self):
        run("figures", "--out", self.folder / "figures")
        envelope = self.folder / "envelope.csv"
        run("simulate", "--plate", "membrane", "--turning-point", "120mm", "--for", "20ms", "--out", envelope)
        tables = [*sorted((self.folder / "figures").glob("*.csv")), envelope, *self.csv]
        self.assertGreater(len(tables), 10)
        for path in tables:
            read = table(path)
            first = next(line for line in path.read_text().splitlines() if not line.startswith("#"))
            self.assertEqual(len(read.columns), len(table(path, header=None, nrows=1).columns), path)
            self.assertGreater(len(read), 2, path)
            self.assertFalse(read.index.dtype == object, f"{path}: cells beyond the head: {first}")
            numbers = read.columns[2:3] if "panel" in read.columns else read.columns[:1]
            self.assertTrue(np.isfinite(read[numbers].to_numpy(float)).all(), path)

    def test_a_universal_file_opens_in_pyuff(self):
        path = self.folder / "far.uff"
        run("measure", *MEASURED, "--sensor", "187mm", "--points", "32", "--out", path)
        read = pyuff.UFF(str(path)).read_sets()
        self.assertEqual((read["type"], read["func_type"], len(read["x"])), (58, 4, 32))
        self.assertTrue(np.all(np.diff(read["x"]) > 0) and np.all(np.abs(read["data"]) > 0))

    def calibrated(self, *arguments):
        found = json.loads(run("calibrate", "--plate", "al-bending", "--json", *arguments))
        self.assertTrue(found["accepted"])
        # How far the edges give is about zero: a share of it says nothing.
        return np.array([it["value"] for it in found["parameters"] if it["name"] != "edge_give_m"])

    def test_files_of_other_programs_calibrate_like_slipline_files(self):
        own = self.calibrated("--data", self.csv[0], "--data", self.csv[1])
        far = table(self.csv[1])
        sensor = ["--sensor", f"{1e3 * PLACES[1]}mm", "--kind", "displacement"]
        # Others have the sign of the phase the other way round.
        response = far["re"].to_numpy() - 1j * far["im"].to_numpy()
        universal = self.folder / "pyuff.uff"
        dataset = pyuff.prepare_58(
            binary=0, func_type=4, rsp_node=1, rsp_dir=3, ref_node=1, ref_dir=3, data=response,
            x=far["frequency_hz"].to_numpy(), id1="far", rsp_ent_name="plate", ref_ent_name="plate",
            abscissa_spacing=0, abscissa_spec_data_type=18, ordinate_spec_data_type=8, orddenom_spec_data_type=0,
        )
        pyuff.UFF(str(universal)).write_sets(dataset, "overwrite")
        parts = pandas.DataFrame({"freq": far["frequency_hz"], "Real": response.real, "Imag": response.imag})
        comma, wide = self.folder / "parts.csv", self.folder / "parts.txt"
        parts.to_csv(comma, index=False)
        parts.to_csv(wide, index=False, sep="\t", encoding="utf-16")
        found = [
            self.calibrated("--data", self.csv[0], "--data", path, *sensor) for path in (universal, comma, wide)
        ]
        # These files state no noise, so the answers weigh a little otherwise than in the own one. How much depends on the
        # noise, another one in each run: 0.05 to 0.8 % of the loss factor in seven runs, less of the others.
        for values in found:
            self.assertTrue(close(values, own, 2e-2), f"{values} {own}")
        self.assertTrue(close(found[2], found[1]), "UTF-16 has all digits")

    def test_cut_files_and_recordings_open(self):
        design = ["design", "--material", "aluminium", "--thickness", "2mm", "--band", "20kHz..40kHz", "--length", "300mm"]
        run(*design, "--out", self.folder / "design")
        for name in ("plate", "frame"):
            drawing = ezdxf.readfile(self.folder / "design" / f"{name}.dxf")
            self.assertGreater(len(drawing.modelspace()), 0, name)
            self.assertFalse(drawing.audit().has_errors, name)
        wav = self.folder / "drive.wav"
        run("record", "--plate", "membrane", "--turning-point", "120mm", "--for", "100ms", "--out", wav)
        codes, rate = soundfile.read(wav, dtype="int16")
        self.assertEqual((rate, len(codes)), (400_000, 40_000))
        self.assertGreater(np.abs(codes).max(), 1000)


if __name__ == "__main__":
    unittest.main()
