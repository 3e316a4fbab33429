//! What is computed on a plate: the calls of the class.

use super::numbers::{flatten, frequencies_of, frequency_of, replaced};
use super::{Plate, check_length, file_failure, named};
use crate::actual::PlateArgument;
use crate::arguments::{ArrayLike, OneOrMore, SERIES_MAX, count_in, in_range, items, pair};
use crate::calibrate;
use crate::error::Failure;
use crate::field;
use crate::finger::FingerArgument;
use crate::measurement::Measurement;
use crate::place::at_most_one;
use crate::result::kind::{Calibration, Check, Field, Merit, Simulation, Table, Texture};
use crate::result::{Answer, Answers, columns, fields};
use crate::simulate;
use crate::texture;
use crate::waiting::compute;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use serde_json::Value;
use slipline_model::answer::check::{CheckAnswer, check};
use slipline_model::answer::merit::{MeritAnswer, rate};
use slipline_model::answer::table::BuiltTable;
use slipline_model::field::asked_place::turning_point_on;
use slipline_model::field::simulation::{SAMPLE_RATE_HZ, table_for_watched};
use slipline_plate::check::Conditions;
use slipline_plate::quantity::{PlaceOrFrequency, Range};
use slipline_plate::texture::Palette;
use slipline_plate::{KNOTS_MAX, PLATE_FILE_BYTES_MAX, PlateFileError, sample_rates};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::PathBuf;
use std::sync::Arc;

#[pymethods]
impl Plate {
    #[new]
    fn new(name_or_path: PathBuf) -> PyResult<Self> {
        Ok(named(&name_or_path.to_string_lossy())?.into())
    }

    /// The plate of a plate file's text.
    ///
    /// Raises ``BadFile``, or ``OutOfRange`` with the field of the file.
    #[classmethod]
    fn from_toml(_class: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        check_length("the plate", text, PLATE_FILE_BYTES_MAX)?;
        let plate = slipline_plate::Plate::from_toml(text);
        Ok(plate.map_err(|error: PlateFileError| file_failure(&error))?.into())
    }

    /// The text of its plate file.
    fn to_toml(&self) -> String {
        self.plate.to_toml()
    }

    /// Name.
    #[getter]
    fn name(&self) -> &str {
        self.plate.name()
    }

    /// From the driven to the narrow end, metres.
    #[getter]
    fn length_m(&self) -> f64 {
        self.plate.length_m()
    }

    /// The nearest and the farthest turning point, metres from the driven end.
    #[getter]
    fn span_m(&self) -> (f64, f64) {
        self.plate.span_m()
    }

    /// The frequencies of these two turning points, Hz.
    #[getter]
    fn band_hz(&self) -> (f64, f64) {
        self.plate.band_hz()
    }

    /// The frequency whose wave turns at ``turning_point_m``, Hz: a number, or an array for a series.
    ///
    /// Raises ``OutOfRange`` beyond the plate's span.
    fn frequency_hz<'py>(
        &self,
        py: Python<'py>,
        turning_point_m: ArrayLike<'_>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let places_m = turning_point_m.one_or_more("turning_point_m", SERIES_MAX)?;
        places_m.map(|place_m| frequency_of(&self.plate, place_m))?.into_python(py)
    }

    /// The turning point of the wave of ``frequency_hz``, metres: a number, or an array for a series.
    ///
    /// Raises ``OutOfRange`` beyond the plate's band.
    fn turning_point_m<'py>(
        &self,
        py: Python<'py>,
        frequency_hz: ArrayLike<'_>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let frequencies_hz = frequency_hz.one_or_more("frequency_hz", SERIES_MAX)?;
        let turns = |hz| turning_point_on(PlaceOrFrequency::Frequency(hz), &self.plate);
        frequencies_hz.map(|hz| turns(hz).map_err(|it| Failure::of(&it)))?.into_python(py)
    }

    /// The plate with other numbers: ``plate.replace(loss_factor=0.02, taper={"rate_per_m": 4.1})``. Paths of the file are taken,
    /// too: ``plate.replace(**{"taper.rate_per_m": 4.1})``.
    ///
    /// Raises ``OutOfRange``; ``TypeError`` for a number that its file does not state.
    #[pyo3(signature = (**numbers))]
    fn replace(&self, numbers: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut changes = Vec::new();
        if let Some(numbers) = numbers {
            flatten("", numbers, &mut changes)?;
        }
        replaced(&self.plate, &changes)
    }

    /// The fields of its plate file as plain data.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("tomllib")?.call_method1("loads", (self.to_toml(),))
    }

    fn __repr__(&self) -> String {
        let (low_hz, high_hz) = self.plate.band_hz();
        let (name, length_m) = (self.plate.name(), self.plate.length_m());
        format!("<slipline.Plate {name:?}: {length_m} m, {low_hz:.6} to {high_hz:.6} Hz>")
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.plate == other.plate
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.plate.to_toml().hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let from_toml = py.get_type::<Self>().getattr("from_toml")?;
        (from_toml, (self.to_toml(),)).into_pyobject(py)
    }

    /// The lights of the plate, as ``slipline check``: at one place, or the worst over its span.
    ///
    /// ``level`` is that of the tone, 0 to 1 of the table's full scale; ``off_centre`` is a drive beside the centre line.
    /// ``linear_share`` is the share of full scale within which the output of a board's DAC is linear, 0.1 to 1: ``linear_share`` of
    /// :meth:`Device.status`.
    /// ``.worst`` is the worst colour; ``.lights`` is a list with ``name``, ``value``, ``unit``, ``colour`` and ``sentence``.
    ///
    /// Raises ``OutOfRange``; ``Refused`` if no tone of this level has this felt edge, or the plate has no table.
    #[pyo3(signature = (*, felt_edge_m=None, turning_point_m=None, frequency_hz=None, level=1.0, off_centre=false, linear_share=1.0))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn check(
        &self,
        py: Python<'_>,
        felt_edge_m: Option<f64>,
        turning_point_m: Option<f64>,
        frequency_hz: Option<f64>,
        level: f64,
        off_centre: bool,
        linear_share: f64,
    ) -> PyResult<Answer<Check>> {
        let asked = at_most_one(felt_edge_m, turning_point_m, frequency_hz)?;
        let plate = Arc::clone(&self.plate);
        let found = compute(py, move |progress| {
            in_range("level", level, crate::place::LEVEL)?;
            let turns =
                |asked| crate::place::turning_point_m(asked, &plate, level, &mut progress.part(0.0, 0.4));
            let turning_point_m = asked.map(turns).transpose()?;
            let conditions = Conditions { level, off_centre, linear_share, ..Conditions::default() };
            let report = check(&plate, turning_point_m, conditions, &mut progress.part(0.4, 1.0));
            Ok(fields(&CheckAnswer::of(&report.map_err(|error| Failure::of(&error))?)))
        })?;
        Answer::of(py, found)
    }

    /// The field at one frequency or at several, as ``slipline respond``: those of ``frequency_hz``, or of the tones with these
    /// turning points or felt edges; a felt edge is that of a tone of ``level``.
    ///
    /// ``points`` places, 8 to 200 001, lie from the driven to the narrow end. ``finger`` is ``(place_m, "light")``,
    /// ``(place_m, "firm")``, or ``(place_m, resistance_n_s_per_m, mass_kg, contact_m)``. ``paper_mode`` is the paper's equation;
    /// ``two_dimensions`` solves the whole plate, too. Of a sequence of n frequencies each number is an array of shape
    /// (n,), and ``amplitude`` one of shape (n, points).
    ///
    /// Raises ``OutOfRange``: ``frequency_hz`` goes from the cut-off at the wide end to four times the highest that turns on
    /// the plate, and a call takes up to 100 000 of them; ``MemoryError`` where the result has no room.
    #[pyo3(signature = (frequency_hz=None, *, turning_point_m=None, felt_edge_m=None, level=0.8, points=2001, finger=None, paper_mode=false, two_dimensions=false))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn respond(
        &self,
        py: Python<'_>,
        frequency_hz: Option<ArrayLike<'_>>,
        turning_point_m: Option<ArrayLike<'_>>,
        felt_edge_m: Option<ArrayLike<'_>>,
        level: f64,
        points: i64,
        finger: Option<FingerArgument>,
        paper_mode: bool,
        two_dimensions: bool,
    ) -> PyResult<Answer<Field>> {
        let finger = finger.map(|FingerArgument(finger)| finger);
        let points = count_in("points", points, field::POINTS)?;
        let asked = field::Asked { points, finger, paper_mode, two_dimensions };
        match frequencies_of(py, &self.plate, [frequency_hz, turning_point_m, felt_edge_m], level)? {
            OneOrMore::One(hz) => field::at_one(py, &self.plate, hz, asked),
            OneOrMore::More(each_hz) => field::at_each(py, self, each_hz, asked),
        }
    }

    /// The drive table, as ``slipline table``: its knots as the arrays ``position_m``, ``frequency_hz``, ``gain`` and
    /// ``peak_present``, its checksum ``crc`` and the rest.
    ///
    /// Raises ``OutOfRange`` for ``sample_rate_hz`` and for ``knots`` (2 to 1025); ``Refused`` if the plate has no table.
    #[pyo3(signature = (*, sample_rate_hz=400e3, knots=1025))]
    fn table(&self, py: Python<'_>, sample_rate_hz: f64, knots: i64) -> PyResult<Answer<Table>> {
        let plate = Arc::clone(&self.plate);
        let found = compute(py, move |progress| {
            in_range("sample_rate_hz", sample_rate_hz, sample_rates(&plate))?;
            let knots = count_in("knots", knots, Range::new(2.0, KNOTS_MAX as f64, ""))?;
            let built = BuiltTable::build(&plate, sample_rate_hz, knots, progress);
            let mut found = fields(&built.map_err(|error| Failure::of(&error))?.answer(&plate));
            if let Some(Value::Array(knots)) = found.remove("knots") {
                found.extend(columns(knots));
            }
            Ok(found)
        })?;
        Answer::of(py, found)
    }

    /// A drive through the whole signal chain and on the plate in time, as ``slipline simulate``.
    ///
    /// The tones are named by one of ``felt_edge_m``, ``turning_point_m`` and ``frequency_hz``: a number, or a sequence of up to
    /// 16. ``level`` is 0 to 1, one for all or one for each; 0.8 by default. ``actual_plate`` is a ``Plate``, a name or
    /// ``"secret:SEED"``; ``duration_s`` is 0.01 to 600; ``no_table`` drives without the table's gains, ``sheet`` solves the sheet in
    /// two dimensions; ``finger`` is as for ``respond``, ``feeling`` a file, and ``setup`` a setup file, in the place of tones.
    ///
    /// The fields are those of the first tone and of all; ``.tones`` has those of each.
    ///
    /// Raises ``OutOfRange``; ``Refused`` if no tone of this level has this felt edge, or the sum of the tones is too large;
    /// ``BadFile``.
    #[pyo3(signature = (*, felt_edge_m=None, turning_point_m=None, frequency_hz=None, level=None, actual_plate=None, duration_s=None, no_table=false, sheet=false, finger=None, feeling=None, setup=None))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn simulate(
        &self,
        py: Python<'_>,
        felt_edge_m: Option<ArrayLike<'_>>,
        turning_point_m: Option<ArrayLike<'_>>,
        frequency_hz: Option<ArrayLike<'_>>,
        level: Option<ArrayLike<'_>>,
        actual_plate: Option<PlateArgument<'_>>,
        duration_s: Option<f64>,
        no_table: bool,
        sheet: bool,
        finger: Option<FingerArgument>,
        feeling: Option<PathBuf>,
        setup: Option<PathBuf>,
    ) -> PyResult<Answer<Simulation>> {
        let places = [felt_edge_m, turning_point_m, frequency_hz];
        let finger = finger.map(|FingerArgument(finger)| finger);
        let options = simulate::Options { actual_plate, duration_s, no_table, sheet, finger, feeling, setup };
        simulate::run(py, &self.plate, places, level, options)
    }

    /// A texture, as ``slipline texture``; one of these is wanted:
    ///
    /// ``solid_m``: an even area to the place where the finger feels it end. ``profile``: two arrays, places in metres and the
    /// wanted RMS amplitude in any unit. ``image``: a PNG file, whose middle row is the profile. ``stripes_m``: the nodes of one
    /// tone, this far apart. ``beat``: ``(place_m, beat_hz)``. ``tones`` is the largest number of tones, 1 to 16.
    ///
    /// Raises ``OutOfRange``, ``Refused`` if the plate cannot have it, ``BadFile`` for the image.
    #[pyo3(signature = (*, solid_m=None, profile=None, image=None, stripes_m=None, beat=None, tones=16))]
    #[expect(clippy::too_many_arguments, reason = "one for each kind of texture")]
    fn texture(
        &self,
        py: Python<'_>,
        solid_m: Option<f64>,
        profile: Option<Bound<'_, PyAny>>,
        image: Option<PathBuf>,
        stripes_m: Option<f64>,
        beat: Option<Bound<'_, PyAny>>,
        tones: i64,
    ) -> PyResult<Answer<Texture>> {
        let profile = profile.map(|given| texture::profile(&given)).transpose()?;
        let beat = beat.map(|given| pair("beat", &given, "(place_m, beat_hz)")).transpose()?;
        let wanted = texture::Wanted { solid_m, profile, image, stripes_m, beat };
        texture::run(py, &self.plate, wanted, tones)
    }

    /// Figures of merit, as ``slipline merit``: a list, of one boundary or of up to five over the span.
    ///
    /// Raises ``OutOfRange``; ``Refused`` if there is no room for an even area before any of them.
    #[pyo3(signature = (*, turning_point_m=None))]
    fn merit(&self, py: Python<'_>, turning_point_m: Option<f64>) -> PyResult<Answers<Merit>> {
        let asked = at_most_one(None, turning_point_m, None)?;
        let plate = Arc::clone(&self.plate);
        let found = compute(py, move |progress| {
            let turns =
                |asked| crate::place::turning_point_m(asked, &plate, 1.0, &mut progress.part(0.0, 0.0));
            let one = asked.map(turns).transpose()?;
            let table = table_for_watched(&plate, SAMPLE_RATE_HZ, &mut progress.part(0.0, 0.2));
            let (table, _) = table.map_err(|error| Failure::of(&error))?;
            let palette = Palette::new(&plate, &table);
            let merits = rate(&palette, one, &mut progress.part(0.2, 1.0));
            let merits = merits.map_err(|error| Failure::of(&error))?;
            Ok(MeritAnswer::of(&plate, &merits).turning_points.iter().map(fields).collect::<Vec<_>>())
        })?;
        let merits = found.into_iter().map(|merit| Answer::of(py, merit));
        Ok(Answers(merits.collect::<PyResult<Vec<_>>>()?))
    }

    /// The plate with its numbers fitted, as ``slipline calibrate``, by measurements of one sensor at two places or at one, by
    /// the drive's current, or by felt edges.
    ///
    /// ``measurements`` is a sequence of one to three ``Measurement`` (a third place is a check), or ``()`` with ``touch``.
    /// ``current`` is ``"coil"`` or ``"piezo"``: the measurement is that of the current. ``touch`` is a sequence of
    /// ``(asked_m, felt_m)``, with ``level``, ``touch_tolerance_m``, ``touched_drive`` (``"as-told"`` or ``"unknown"``) and
    /// ``feeling`` (a file). The calipers gave ``half_width_m``, ``end_half_width_m`` and ``length_m``, within
    /// ``calipers_tolerance_m``.
    ///
    /// ``.plate`` is the calibrated plate, or ``None`` where ``.accepted`` is false; then ``.reason`` says why.
    ///
    /// Raises ``OutOfRange``, ``Refused`` and ``BadFile``. After Ctrl-C the fit runs on in the background, and its
    /// result is dropped.
    #[pyo3(signature = (measurements, *, current=None, touch=None, level=None, touch_tolerance_m=None, touched_drive=None, feeling=None, half_width_m=None, end_half_width_m=None, length_m=None, calipers_tolerance_m=None))]
    #[expect(clippy::too_many_arguments, reason = "they are the keywords of the call")]
    fn calibrate(
        &self,
        py: Python<'_>,
        measurements: &Bound<'_, PyAny>,
        current: Option<&str>,
        touch: Option<Bound<'_, PyAny>>,
        level: Option<f64>,
        touch_tolerance_m: Option<f64>,
        touched_drive: Option<&str>,
        feeling: Option<PathBuf>,
        half_width_m: Option<f64>,
        end_half_width_m: Option<f64>,
        length_m: Option<f64>,
        calipers_tolerance_m: Option<f64>,
    ) -> PyResult<Answer<Calibration>> {
        let measurements: Vec<Bound<'_, Measurement>> = items("measurements", measurements, 3)?;
        let measured = measurements.iter().map(|measurement| Arc::clone(&measurement.get().inner)).collect();
        let current = calibrate::transducer(current)?;
        let calipers = calibrate::calipers(half_width_m, end_half_width_m, length_m, calipers_tolerance_m)?;
        let touches = calibrate::Touches { touch, level, touch_tolerance_m, touched_drive, feeling };
        calibrate::run(py, &self.plate, measured, current, calipers, touches.read()?)
    }
}
