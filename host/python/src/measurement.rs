//! The class `Measurement`: the response of a sensor at one place, over frequency.

use crate::arguments::{ArrayLike, Item, count_in, in_range, one_of, optional};
use crate::error::Failure;
use crate::plate::{Plate, check_length};
use numpy::{Complex64, PyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};
use slipline_instrument::measure::{PLAYED_BYTES_MAX, PlayedSweep};
use slipline_instrument::measured_file::{
    BYTES_MAX, ForeignError, ForeignMetadata, OpenError, Opened, RecordingMetadata, measurement, recorded,
};
use slipline_model::atomic_file::{self, read_bytes, read_text, said};
use slipline_plate::calibrate::{FileError, MeasuredPoint, SNR_DB, SensorKind, band_hz};
use slipline_plate::quantity::{Range, must_be};
use slipline_plate::text_table::{Chosen, chosen};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most points of a measurement.
const POINTS_MAX: usize = 10_000;
/// Signal-to-noise ratios of a measurement that states no noise.
const SNRS: Range = Range::new(0.0, 140.0, "dB");
/// Most channels of a WAV file.
const CHANNEL_MAX: f64 = 65_535.0;

/// The response of a sensor at one place of a plate, over frequency.
///
/// The response is the sensor's signal over the DAC's amplitude: the signal is ``Re(response e^(-j omega t))`` for a code
/// of ``cos(omega t)``.
#[pyclass(frozen, module = "slipline")]
#[derive(Debug)]
pub(crate) struct Measurement {
    pub(crate) inner: Arc<slipline_plate::calibrate::Measurement>,
    /// What was read of a file by another program.
    source: Option<String>,
}

impl From<Arc<slipline_plate::calibrate::Measurement>> for Measurement {
    fn from(inner: Arc<slipline_plate::calibrate::Measurement>) -> Self {
        Self { inner, source: None }
    }
}

impl From<slipline_plate::calibrate::Measurement> for Measurement {
    fn from(inner: slipline_plate::calibrate::Measurement) -> Self {
        Self { inner: Arc::new(inner), source: None }
    }
}

impl Measurement {
    fn column<'py>(&self, py: Python<'py>, of: impl Fn(&MeasuredPoint) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.inner.points.iter().map(of).collect())
    }
}

impl<'py> Item<'py> for Bound<'py, Measurement> {
    const WORDS: &'static str = "Measurement";

    fn of(given: &Bound<'py, PyAny>) -> Option<Self> {
        given.cast::<Measurement>().ok().cloned()
    }
}

#[pymethods]
impl Measurement {
    /// Reads a measurement's file.
    ///
    /// One of this package is complete. One of another program (REW, .frd, a table, a universal file 58) and a recording of a
    /// sweep (WAV) need the ``plate`` and the sensor's ``place_m`` from the driven end; ``kind`` is displacement,
    /// velocity, acceleration or strain, ``snr_db`` the signal-to-noise ratio in dB of a file that states no noise. A recording
    /// needs ``played``, the description that ``slipline sweep`` wrote, and has the sensor in ``channel``, from 1. ``columns``
    /// says what the columns of a table are where their names are not clear: ``"frequency=1,level=3:dB,phase=4:rad"``. What
    /// was read of it is in ``source``.
    ///
    /// Raises ``BadFile`` with what is missing or wrong.
    #[classmethod]
    #[pyo3(signature = (path, *, plate=None, place_m=None, kind=None, snr_db=SNR_DB, played=None, channel=1, columns=None))]
    #[expect(clippy::too_many_arguments, reason = "one for each property that a file may lack")]
    fn read(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        path: PathBuf,
        plate: Option<&Bound<'_, Plate>>,
        place_m: Option<f64>,
        kind: Option<&str>,
        snr_db: f64,
        played: Option<PathBuf>,
        channel: i64,
        columns: Option<&str>,
    ) -> PyResult<Self> {
        let plate = plate.map(|plate| Arc::clone(&plate.get().plate));
        let kind = kind.map(|word| sensor_kind("kind", word)).transpose()?;
        if let Some(plate) = &plate {
            optional("place_m", place_m, Range::new(0.0, plate.length_m(), "m"))?;
        }
        in_range("snr_db", snr_db, SNRS)?;
        let channel = count_in("channel", channel, Range::new(1.0, CHANNEL_MAX, ""))?;
        let columns = columns.map(chosen).transpose().map_err(Failure::refused)?.unwrap_or_default();
        let stated = Stated { plate, place_m, kind, snr_db, played, channel, columns };
        let (measurement, source) = py.detach(|| stated.read(&path))?;
        Ok(Self { source, ..measurement.into() })
    }

    /// Writes it into a file of this package's format, CSV; an existing file is replaced.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = self.inner.to_csv();
        // Into a pipe it waits for whoever reads.
        let written = py
            .detach(|| atomic_file::write(&path, |out| -> io::Result<()> { out.write_all(text.as_bytes()) }));
        Ok(written.map_err(|error| Failure::bad_file(path.display(), said(&error)))?)
    }

    /// The measurement of a text in this package's format.
    ///
    /// Raises ``BadFile``.
    #[classmethod]
    fn from_csv(_class: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        check_length("the measurement", text, BYTES_MAX)?;
        let read = slipline_plate::calibrate::Measurement::from_csv(text);
        Ok(read.map_err(|error| Failure::bad_file("the measurement", error))?.into())
    }

    /// A measurement of arrays: complex ``response`` at rising ``frequency_hz``, 8 to 10 000 of them.
    ///
    /// ``response`` is the sensor's signal over the DAC's amplitude, see the class; of an instrument that uses ``e^(+j omega t)`` it
    /// is the complex conjugate. ``place_m`` is the sensor's place, ``sensor`` what it measures. The noise is the standard deviation
    /// of the real and of the imaginary part, a number or a series, ``noise``, or ``snr_db`` below the RMS of the responses.
    /// ``sample_rate_hz`` is that of a DAC with a zero-order hold. ``sensor_mass_kg`` (to 0.1, within a fifth) and
    /// ``sensor_width_m`` are those of a sensor that stands on the plate and lessens the motion that it measures.
    ///
    /// Raises ``OutOfRange``.
    #[classmethod]
    #[pyo3(signature = (frequency_hz, response, *, place_m, sensor="displacement", noise=None, snr_db=None, unit_per_response=None, sample_rate_hz=None, place_tolerance_m=None, headroom_db=None, sensor_mass_kg=0.0, sensor_width_m=0.0))]
    #[expect(clippy::too_many_arguments, reason = "one for each property")]
    fn from_arrays(
        _class: &Bound<'_, PyType>,
        frequency_hz: ArrayLike<'_>,
        response: ArrayLike<'_>,
        place_m: f64,
        sensor: &str,
        noise: Option<ArrayLike<'_>>,
        snr_db: Option<f64>,
        unit_per_response: Option<f64>,
        sample_rate_hz: Option<f64>,
        place_tolerance_m: Option<f64>,
        headroom_db: Option<ArrayLike<'_>>,
        sensor_mass_kg: f64,
        sensor_width_m: f64,
    ) -> PyResult<Self> {
        let frequencies_hz = frequency_hz.series("frequency_hz", POINTS_MAX)?;
        let count = frequencies_hz.len();
        let responses = response.complex_series("response", POINTS_MAX)?;
        let noise = match (noise, snr_db) {
            (Some(noise), None) => noise.one_or_more("noise", POINTS_MAX)?.repeated(count),
            (None, snr_db) => {
                let snr_db = snr_db.unwrap_or(SNR_DB);
                in_range("snr_db", snr_db, SNRS)?;
                let square = responses.iter().map(|response| response.norm_sqr()).sum::<f64>();
                let rms = (square / responses.len().max(1) as f64).sqrt();
                vec![(rms * 10f64.powf(-snr_db / 20.0)).max(1e-30); count]
            }
            (Some(_), Some(_)) => {
                return Err(Failure::wrong_arguments("noise and snr_db", "one of them").into());
            }
        };
        let headroom_db = match headroom_db {
            Some(headroom_db) => headroom_db.one_or_more("headroom_db", POINTS_MAX)?.repeated(count),
            None => vec![f64::NAN; count],
        };
        for (name, length) in
            [("response", responses.len()), ("noise", noise.len()), ("headroom_db", headroom_db.len())]
        {
            if length != count {
                let text = format!("{name} of {length} numbers, and frequency_hz of {count}");
                return Err(Failure::value(must_be(text, "as many of each")).into());
            }
        }
        let points = (frequencies_hz.into_iter().zip(responses)).zip(noise.into_iter().zip(headroom_db));
        let points = points.map(|((frequency_hz, response), (noise, headroom_db))| MeasuredPoint {
            frequency_hz,
            response,
            noise,
            headroom_db: Some(headroom_db).filter(|headroom_db| !headroom_db.is_nan()),
        });
        let usual = slipline_plate::calibrate::Measurement::at(
            place_m,
            sensor_kind("sensor", sensor)?,
            points.collect(),
        );
        let place_tolerance_m = place_tolerance_m.unwrap_or(usual.place_tolerance_m);
        let measurement = slipline_plate::calibrate::Measurement {
            place_tolerance_m,
            unit_per_response,
            sample_rate_hz,
            sensor_mass_kg,
            sensor_width_m,
            ..usual
        };
        measurement.check().map_err(|error| Failure::of(&error))?;
        Ok(measurement.into())
    }

    /// Its arrays as an ``xarray.Dataset`` over ``frequency_hz``, with ``units`` and ``long_name``; the rest are its attributes.
    /// Needs xarray: ``pip install slipline[xarray]``.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("slipline.dataset")?.call_method1("of_measurement", (slf,))
    }

    /// The text of its file.
    fn to_csv(&self) -> String {
        self.inner.to_csv()
    }

    /// The sensor's place, metres from the driven end.
    #[getter]
    fn place_m(&self) -> f64 {
        self.inner.place_m
    }

    /// Standard deviation of that place from its mark, metres.
    #[getter]
    fn place_tolerance_m(&self) -> f64 {
        self.inner.place_tolerance_m
    }

    /// What the sensor measures: displacement, velocity, acceleration or strain.
    #[getter]
    fn sensor(&self) -> &'static str {
        self.inner.sensor.word()
    }

    /// Metres, m/s, m/s^2 or strain per unit of ``response``; ``None`` for an uncalibrated sensor.
    #[getter]
    fn unit_per_response(&self) -> Option<f64> {
        self.inner.unit_per_response
    }

    /// Mass of the sensor, kg; 0 for one that does not touch the plate.
    #[getter]
    fn sensor_mass_kg(&self) -> f64 {
        self.inner.sensor_mass_kg
    }

    /// Side of the square on which a sensor with a mass stands, metres.
    #[getter]
    fn sensor_width_m(&self) -> f64 {
        self.inner.sensor_width_m
    }

    /// Sample rate of the DAC that played the tones, Hz; ``None`` for a source without a hold.
    #[getter]
    fn sample_rate_hz(&self) -> Option<f64> {
        self.inner.sample_rate_hz
    }

    /// What was read of a file by another program: its rows, and what its columns were understood as; ``None`` for others. It
    /// is not kept in a file or a pickle.
    #[getter]
    fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// Frequencies, Hz, rising: an array of shape (points,), as are the others.
    #[getter]
    fn frequency_hz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, |point| point.frequency_hz)
    }

    /// Complex responses.
    #[getter]
    fn response<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Complex64>> {
        PyArray1::from_vec(py, self.inner.points.iter().map(|point| point.response).collect())
    }

    /// Standard deviation of the real part and of the imaginary part of each response.
    #[getter]
    fn noise<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, |point| point.noise)
    }

    /// Headroom of the input below its full scale, dB; NaN where it is unknown.
    #[getter]
    fn headroom_db<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, |point| point.headroom_db.unwrap_or(f64::NAN))
    }

    fn __repr__(&self) -> String {
        let slipline_plate::calibrate::Measurement { place_m, sensor, points, .. } = &*self.inner;
        format!("<slipline.Measurement of {} at {place_m} m, {} points>", sensor.word(), points.len())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.inner == other.inner
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let from_csv = py.get_type::<Self>().getattr("from_csv")?;
        (from_csv, (self.to_csv(),)).into_pyobject(py)
    }
}

/// The quantity of a sensor by its word.
/// `name` is that of the argument.
pub(crate) fn sensor_kind(name: &str, word: &str) -> Result<SensorKind, Failure> {
    one_of(name, word, &SensorKind::ALL.map(|kind| (kind.word(), kind)))
}

/// Properties that a file may lack.
struct Stated {
    plate: Option<Arc<slipline_plate::Plate>>,
    place_m: Option<f64>,
    kind: Option<SensorKind>,
    snr_db: f64,
    played: Option<PathBuf>,
    channel: usize,
    columns: Vec<Chosen>,
}

impl Stated {
    /// The measurement of a file, and what was read of one by another program.
    fn read(&self, path: &Path) -> Result<(slipline_plate::calibrate::Measurement, Option<String>), Failure> {
        let bad = |why: &dyn std::fmt::Display| Failure::bad_file(path.display(), why);
        let bytes = read_bytes(path, BYTES_MAX).map_err(|error| bad(&said(&error)))?;
        let opened = Opened::read(bytes, &self.columns).map_err(|error| {
            let OpenError::File(FileError::Columns(unclear)) = error else { return bad(&error) };
            bad(&format_args!("{unclear}: say what they are, such as columns=\"frequency=1,level=2:dB\""))
        })?;
        if let Opened::Own(measurement) = opened {
            return Ok((measurement, None));
        }
        let (Some(plate), Some(place_m)) = (&self.plate, self.place_m) else {
            return Err(bad(&"it does not state its place: add plate and place_m"));
        };
        let untold = |error: ForeignError| {
            let why = "it does not state what its sensor measures: add kind";
            if matches!(error, ForeignError::Kind) { bad(&why) } else { bad(&error) }
        };
        match opened {
            Opened::Own(measurement) => Ok((measurement, None)),
            Opened::Foreign(foreign) => {
                let kind = self.kind.or(foreign.sensor);
                let stated = ForeignMetadata { place_m, kind, snr_db: self.snr_db };
                let read = foreign.read(band_hz(plate)).to_string();
                measurement(plate, &foreign, &stated).map(|it| (it, Some(read))).map_err(untold)
            }
            Opened::Recording(wav) => {
                let played = self.played.as_ref().ok_or_else(|| bad(&"a recording: add played"))?;
                let text = read_text(played, PLAYED_BYTES_MAX);
                let text = text.map_err(|error| Failure::bad_file(played.display(), said(&error)))?;
                let sweep = PlayedSweep::from_toml(&text);
                let sweep = sweep.map_err(|error| Failure::bad_file(played.display(), error))?;
                let stated = RecordingMetadata { place_m, kind: self.kind, channel: self.channel };
                recorded(plate, &wav, &sweep, &stated).map(|(it, _)| (it, None)).map_err(untold)
            }
        }
    }
}
