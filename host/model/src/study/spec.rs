//! The specification of a study, as TOML.
//!
//! ```toml
//! plate = "membrane"             # a preset or a file; or a section [plate] with a plate file
//! seed = 7                       # 0 to 9223372036854775807
//! count = 10000                  # plates, 1 to 1 000 000
//! turning_point_m = [0.12, 0.18] # 1 to 64 places on the span of the plate
//! kind = "1d"                    # or "2d": each plate in two dimensions
//! results = ["level_db"]         # 1 to 7 of StudyResult::ALL
//! [vary]                         # 1 to 32 numbers of the plate file, each times a factor, or plus an offset
//! "model.wave_speed_m_per_s" = { normal = 0.01 }   # 1 + 0.01 z, z standard normal; 0 to 1
//! loss_factor = { log_normal = 0.3 }               # e^(0.3 z); 0 to 3
//! "taper.rate_per_m" = { uniform = 0.02 }          # 1 + 0.02 u, u uniform in -1 to 1; 0 to 1
//! edge_give_m = { offset = 3e-4 }                  # plus 3e-4 z, z standard normal; 0 to 1 in the field's unit
//! ```

use super::law::Law;
use super::results::{Kind, StudyResult};
use serde::{Deserialize, Serialize};
use slipline_plate::quantity::{Count, Counted, Range, WrongCount, nearest};
use slipline_plate::{Plate, PlateError, PlateFile, PlateFileError};
use std::collections::BTreeMap;

/// The largest specification that is read, bytes: a plate file of the largest size fits.
pub const SPEC_BYTES_MAX: usize = 1 << 21;
/// Most plates of a study.
pub(crate) const COUNT_MAX: u64 = 1_000_000;
/// Most places of a study.
pub(crate) const PLACES_MAX: usize = 64;
/// Most names of results: a name may stand twice.
const RESULTS_MAX: usize = 64;
/// Most fields that vary.
const VARIED_MAX: usize = 32;

/// Why a specification is refused.
#[derive(Debug, thiserror::Error)]
pub enum SpecError {
    /// The text is too long.
    #[error("{0}")]
    TooBig(#[source] WrongCount),
    /// Not TOML, or not of this form.
    #[error("line {line}: {message}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The parser's message.
        message: String,
    },
    /// The plate in the specification is refused.
    #[error("plate: {0}")]
    Plate(#[from] PlateFileError),
    /// A value is not allowed.
    #[error("{0}")]
    Value(#[from] PlateError),
    /// A place is not on the span of the plate.
    #[error("{0}, the plate's span")]
    OffSpan(#[source] PlateError),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SpecText {
    seed: i64,
    count: i64,
    turning_point_m: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    results: Option<Vec<String>>,
    vary: BTreeMap<String, Law>,
    plate: toml::Value,
}

/// A specification whose plate may still be a name.
#[derive(Debug)]
pub struct Draft {
    seed: u64,
    count: u64,
    turning_point_m: Vec<f64>,
    kind: Kind,
    results: Vec<StudyResult>,
    vary: BTreeMap<String, Law>,
    plate: PlateOf,
}

#[derive(Debug)]
enum PlateOf {
    Named(String),
    Own(Box<Plate>),
}

/// A field that varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// The field's path in the plate file, such as `taper.rate_per_m`.
    pub path: String,
    /// The law of its factor.
    pub law: Law,
    /// Its number on the nominal plate.
    pub nominal: f64,
}

impl Varied {
    /// Its name as a column: `vary_taper_rate_per_m`.
    #[must_use]
    pub fn column(&self) -> String {
        format!("vary_{}", self.path.replace('.', "_"))
    }
}

/// A valid specification.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    pub(super) seed: u64,
    pub(super) count: u64,
    pub(super) turning_point_m: Vec<f64>,
    pub(super) kind: Kind,
    /// In the order of their columns.
    pub(super) results: Vec<StudyResult>,
    /// In the order of their paths.
    pub(super) varied: Vec<Varied>,
    /// The nominal plate's file, with every field.
    pub(super) plate_text: String,
}

impl Draft {
    /// Reads a specification.
    ///
    /// # Errors
    /// [`SpecError`]: too long, not TOML, a field that is missing, unknown, of the wrong type or out of range.
    pub fn parse(text: &str) -> Result<Self, SpecError> {
        let allowed = Count::at_most(SPEC_BYTES_MAX, Counted::Bytes);
        WrongCount::check("the specification", text.len(), allowed).map_err(SpecError::TooBig)?;
        let parsed: SpecText = toml::from_str(text).map_err(|fault| syntax(text, &fault))?;
        let seed = whole("seed", parsed.seed, 0, i64::MAX as u64)?;
        let count = whole("count", parsed.count, 1, COUNT_MAX)?;
        let places = Count::new(1, PLACES_MAX, Counted::Points);
        places.check("turning_point_m", parsed.turning_point_m.len())?;
        let kind = parsed.kind.as_deref().map_or(Ok(Kind::default()), Kind::of)?;
        let results = match &parsed.results {
            None => kind.usual_results().to_vec(),
            Some(names) => {
                Count::new(1, RESULTS_MAX, Counted::Fields).check("results", names.len())?;
                StudyResult::read(names, kind)?
            }
        };
        Count::new(1, VARIED_MAX, Counted::Fields).check("vary", parsed.vary.len())?;
        for (path, law) in &parsed.vary {
            let (width, range) = law.width();
            range.check(format_args!("vary.{path:?}.{}", law.name()), width)?;
        }
        let plate = match parsed.plate {
            toml::Value::String(name) => PlateOf::Named(name),
            toml::Value::Table(table) => PlateOf::Own(Box::new(own_plate(&table)?)),
            other @ (toml::Value::Integer(_)
            | toml::Value::Float(_)
            | toml::Value::Boolean(_)
            | toml::Value::Datetime(_)
            | toml::Value::Array(_)) => {
                let allowed = "a preset's name, a file's name, or a section [plate] with a plate file";
                return Err(SpecError::Value(PlateError::UnknownKind {
                    field: "plate".to_owned(),
                    value: other.to_string().chars().take(40).collect(),
                    allowed: allowed.to_owned(),
                }));
            }
        };
        let SpecText { turning_point_m, vary, .. } = parsed;
        Ok(Self { seed, count, turning_point_m, kind, results, vary, plate })
    }

    /// The preset or file that the caller is to find; `None` if the specification has its plate in it.
    #[must_use]
    pub fn plate_name(&self) -> Option<&str> {
        match &self.plate {
            PlateOf::Named(name) => Some(name),
            PlateOf::Own(_) => None,
        }
    }

    /// The specification on its own plate, or else on `named`.
    ///
    /// # Errors
    /// [`SpecError`]: a place that is not on the plate's span, a field that the plate has no number for.
    pub fn finish(self, named: Option<Plate>) -> Result<Spec, SpecError> {
        let Self { seed, count, turning_point_m, kind, results, vary, plate } = self;
        let plate = match (plate, named) {
            (PlateOf::Own(plate), _) => *plate,
            (PlateOf::Named(_), Some(plate)) => plate,
            (PlateOf::Named(_), None) => {
                let needed = "the plate of this name".to_owned();
                return Err(SpecError::Value(PlateError::Missing { field: "plate".to_owned(), needed }));
            }
        };
        let (start_m, end_m) = plate.span_m();
        for (number, &place_m) in turning_point_m.iter().enumerate() {
            let span = Range::new(start_m, end_m, "m");
            span.check(format_args!("turning_point_m[{number}]"), place_m).map_err(SpecError::OffSpan)?;
        }
        let mut spec = plate.spec().clone();
        if vary.contains_key("edge_give_m") {
            // A file that leaves it out means edges that do not give.
            spec.edge_give_m.get_or_insert(0.0);
        }
        if vary.contains_key("loss_exponent") {
            spec.loss_exponent.get_or_insert(0.0);
        }
        let plate_text = Plate::new(spec)?.to_toml();
        let numbers = PlateFile::parse(&plate_text)?.0.numbers();
        let varied = vary.into_iter().map(|(path, law)| varied(path, law, &numbers));
        let varied = varied.collect::<Result<_, _>>()?;
        Ok(Spec { seed, count, turning_point_m, kind, results, varied, plate_text })
    }
}

impl Spec {
    /// The seed.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The number of plates.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The places, metres: turning points on the nominal plate.
    #[must_use]
    pub fn turning_point_m(&self) -> &[f64] {
        &self.turning_point_m
    }

    /// The equation by which each plate is solved.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// The results of each plate and place, in the order of their columns.
    #[must_use]
    pub fn results(&self) -> &[StudyResult] {
        &self.results
    }

    /// The fields that vary, in the order of their paths.
    #[must_use]
    pub fn varied(&self) -> &[Varied] {
        &self.varied
    }

    /// The specification as text, the same for equal specifications: with its whole plate, every field, in one order.
    /// [`Draft::parse`] reads it back.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Default values are left out, so that the text of a study from before the choice existed stays the same.
        let names = || self.results.iter().map(|it| it.name().to_owned()).collect();
        let text = SpecText {
            seed: i64::try_from(self.seed).unwrap_or(i64::MAX),
            count: i64::try_from(self.count).unwrap_or(i64::MAX),
            turning_point_m: self.turning_point_m.clone(),
            kind: (self.kind != Kind::default()).then(|| self.kind.name().to_owned()),
            results: (self.results != self.kind.usual_results()).then(names),
            vary: self.varied.iter().map(|varied| (varied.path.clone(), varied.law)).collect(),
            plate: toml::Value::Table(toml::from_str(&self.plate_text).unwrap_or_default()),
        };
        toml::to_string(&text).unwrap_or_default()
    }
}

/// The parser's refusal of a text, with its line.
fn syntax(text: &str, fault: &toml::de::Error) -> SpecError {
    let start = fault.span().map_or(0, |span| span.start.min(text.len()));
    let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
    let message = fault.message().trim();
    // An unquoted dot makes a section of what is before it.
    let hint = if message.contains("unknown variant") {
        "; the path of a field in a section stands in quotes, such as \"taper.rate_per_m\" = { uniform = 0.02 }"
    } else {
        ""
    };
    SpecError::Syntax { line, message: format!("{message}{hint}") }
}

fn own_plate(table: &toml::Table) -> Result<Plate, SpecError> {
    let text = toml::to_string(table).unwrap_or_default();
    // The line number belongs to the rewritten text and would mislead.
    Plate::from_toml(&text).map_err(|error| SpecError::Plate(error.without_line()))
}

fn varied(path: String, law: Law, numbers: &[(String, f64)]) -> Result<Varied, SpecError> {
    let field = format!("vary.{path:?}");
    let Some((_, nominal)) = numbers.iter().find(|(name, _)| *name == path) else {
        let names = || numbers.iter().map(|(name, _)| name.as_str());
        let reason = match nearest(&path, names()) {
            Some(near) => format!("did you mean {near}?"),
            None => format!("the numbers of this plate are {}", names().collect::<Vec<_>>().join(", ")),
        };
        return Err(SpecError::Value(PlateError::Unexpected { field, reason }));
    };
    if *nominal == 0.0 && law.is_factor() {
        let reason = "it is 0 on the nominal plate, and no factor changes that: use offset".to_owned();
        return Err(SpecError::Value(PlateError::Unexpected { field, reason }));
    }
    Ok(Varied { path, law, nominal: *nominal })
}

fn whole(field: &str, value: i64, low: u64, high: u64) -> Result<u64, PlateError> {
    let range = Range::new(low as f64, high as f64, "");
    match u64::try_from(value) {
        Ok(value) if (low..=high).contains(&value) => Ok(value),
        _ => {
            Err(PlateError::OutOfRange { field: field.to_owned(), value: value as f64, range, origin: None })
        }
    }
}

#[cfg(test)]
mod tests;
