//! Units of columns, and their size in SI.

use super::quantities::Quantity;
use std::f64::consts::{PI, TAU};

/// A unit, with its size in hertz, radians, seconds, or the SI unit of a magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Of a frequency.
    Hertz(f64),
    /// Twenty times the decimal logarithm of a magnitude.
    Decibels,
    /// Of a phase.
    Radians(f64),
    /// Of a time.
    Seconds(f64),
    /// Of a magnitude, with the quantity that it belongs to.
    Linear(f64, Option<Quantity>),
}

impl Unit {
    /// Whether a quantity may have this unit.
    pub(crate) fn suits(self, of: Quantity) -> bool {
        match self {
            Self::Hertz(_) => of == Quantity::Frequency,
            Self::Decibels => of.is_level(),
            Self::Radians(_) => of == Quantity::Phase,
            Self::Seconds(_) => of == Quantity::Time,
            Self::Linear(_, kind) => match of {
                Quantity::Place => kind == Some(Quantity::Displacement),
                Quantity::Magnitude | Quantity::Real | Quantity::Imaginary => true,
                Quantity::Displacement | Quantity::Velocity | Quantity::Acceleration | Quantity::Strain => {
                    kind.is_none_or(|kind| kind == of)
                }
                // "Level (m/s)" is a magnitude that is called a level.
                Quantity::Level => true,
                _ => false,
            },
        }
    }

    /// Hertz, radians, seconds or SI units per unit; 1 for decibels.
    #[must_use]
    pub const fn size(self) -> f64 {
        match self {
            Self::Hertz(size) | Self::Radians(size) | Self::Seconds(size) | Self::Linear(size, _) => size,
            Self::Decibels => 1.0,
        }
    }
}

/// A unit by its text, with or without brackets; `None` if it is unknown, or could be two.
pub(crate) fn unit(text: &str) -> Option<Unit> {
    let text = text.trim().trim_matches(['[', ']', '{', '}']);
    let text = text.strip_prefix('(').and_then(|it| it.strip_suffix(')')).unwrap_or(text);
    let text = text.replace(" per ", "/").replace(['µ', 'μ'], "u").replace('²', "2").replace('¹', "1");
    let text = text.replace('⁻', "-");
    let is_of_words = text.trim().contains(char::is_whitespace);
    let text: String =
        text.chars().filter(|it| !it.is_whitespace() && !matches!(it, '^' | '.' | '*' | '·' | '⋅')).collect();
    match &*text {
        "MHz" => return Some(Unit::Hertz(1e6)),
        "mHz" => return Some(Unit::Hertz(1e-3)),
        _ => {}
    }
    let lower = text.to_lowercase();
    Some(match &*lower {
        // Such as "rad/s" without its sign.
        "rads" | "degs" if is_of_words => return None,
        "hz" | "hertz" | "cps" | "гц" | "герц" | "赫兹" | "ヘルツ" => Unit::Hertz(1.0),
        "khz" | "kilohertz" | "кгц" => Unit::Hertz(1e3),
        "ghz" => Unit::Hertz(1e9),
        "rad/s" | "rad/sec" | "rads/s" | "radian/s" | "radians/s" | "radian/sec" | "radians/sec"
        | "radians/second" => Unit::Hertz(1.0 / TAU),
        "krad/s" => Unit::Hertz(1e3 / TAU),
        "rpm" | "cpm" | "1/min" | "u/min" => Unit::Hertz(1.0 / 60.0),
        "deg" | "degs" | "degree" | "degrees" | "°" | "º" | "˚" | "grad" | "град" | "grados" | "gradi"
        | "graus" | "degré" | "degrés" | "graden" | "grader" | "grade" | "stopnie" | "stopni" | "fok"
        | "derece" | "aste" | "astetta" | "градусы" | "градусов" | "度" | "도" => {
            Unit::Radians(PI / 180.0)
        }
        "rad" | "rads" | "рад" | "弧度" | "ラジアン" | "radian" | "radians" | "radianes" | "radianti"
        | "radiant" => Unit::Radians(1.0),
        "mrad" => Unit::Radians(1e-3),
        "s" | "sec" | "seconds" => Unit::Seconds(1.0),
        "ms" => Unit::Seconds(1e-3),
        "us" => Unit::Seconds(1e-6),
        "дб" | "decibel" | "decibels" | "分贝" | "デシベル" => Unit::Decibels,
        "%" => Unit::Linear(1e-2, None),
        "lin" | "linear" | "abs" | "ratio" => Unit::Linear(1.0, None),
        _ => match lower.strip_prefix("db") {
            Some("" | "spl" | "fs" | "v" | "u" | "r") => Unit::Decibels,
            Some(re) if re.starts_with("re") => Unit::Decibels,
            _ => return linear(&text),
        },
    })
}

/// The unit of a magnitude, such as mm/s, g or um/N.
fn linear(text: &str) -> Option<Unit> {
    let text = text.replace(['(', ')'], "");
    // Such as m s^-2.
    let powers = [("s-1", "/s"), ("s-2", "/s2")];
    let power = powers.iter().find_map(|(end, by)| text.strip_suffix(end).map(|base| format!("{base}{by}")));
    let text = power.unwrap_or(text);
    let mut parts = text.split('/').peekable();
    let (mut size, mut kind) = base(parts.next()?)?;
    while kind == Some(Quantity::Displacement) || kind == Some(Quantity::Velocity) {
        let (speed, rate) = (Some(Quantity::Velocity), Some(Quantity::Acceleration));
        kind = match parts.peek() {
            Some(&"s" | &"sec") if kind == speed => rate,
            Some(&"s" | &"sec") => speed,
            Some(&"s2" | &"sec2") if kind != speed => rate,
            Some(&"m") if kind != speed => Some(Quantity::Strain),
            _ => break,
        };
        parts.next();
    }
    if let Some(part) = parts.next() {
        let (per, None) = base(part)? else { return None };
        size /= per;
    }
    parts.next().is_none().then_some(Unit::Linear(size, kind))
}

/// A unit without a denominator, with its prefix.
fn base(text: &str) -> Option<(f64, Option<Quantity>)> {
    let whole = |text: &str| {
        Some(match text {
            "m" => (1.0, Some(Quantity::Displacement)),
            "g" | "gn" | "g0" => (9.806_65, Some(Quantity::Acceleration)),
            "ε" | "strain" => (1.0, Some(Quantity::Strain)),
            "V" | "Pa" | "N" | "A" => (1.0, None),
            _ => return None,
        })
    };
    match text {
        "in" => return Some((0.0254, Some(Quantity::Displacement))),
        "mil" => return Some((2.54e-5, Some(Quantity::Displacement))),
        "ft" => return Some((0.3048, Some(Quantity::Displacement))),
        "ue" | "microstrain" => return Some((1e-6, Some(Quantity::Strain))),
        _ => {}
    }
    whole(text).or_else(|| {
        let prefix = text.chars().next()?;
        let (_, size) = PREFIXES.iter().find(|it| it.0 == prefix)?;
        let (of, kind) = whole(&text[prefix.len_utf8()..])?;
        Some((size * of, kind))
    })
}

const PREFIXES: [(char, f64); 8] =
    [('p', 1e-12), ('n', 1e-9), ('u', 1e-6), ('m', 1e-3), ('c', 1e-2), ('k', 1e3), ('M', 1e6), ('G', 1e9)];
