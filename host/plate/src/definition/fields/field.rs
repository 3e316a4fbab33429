//! A field of a plate file, and a section: all that reader, writer, messages, panels and the page on plate files know of them.

use crate::definition::air::Faces;
use crate::definition::source::EndSlope;
use crate::definition::spec::PlateSpec;
use crate::definition::turning_width::TurningWidth;
use crate::quantity::{Caption, Count, Range};
use std::borrow::Cow;

/// Type and range of a field.
pub(crate) enum FieldType {
    /// A number in a range that is the same for every plate.
    Number(Range),
    /// A number whose range depends on other fields; the text describes the range.
    NumberThat(&'static str),
    /// A text with the given number of characters.
    Text(Count),
    /// true or false.
    Flag,
    /// Points of several numbers.
    Points(&'static Columns),
    /// One of the section's kinds.
    Kind,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A section of its own.
    Section,
}

/// A list of points: how many there may be, and what each of them is, in words.
pub(crate) struct Columns {
    pub(super) points: Count,
    /// `a pair [place, half-width] of numbers, in m`.
    pub(crate) one: &'static str,
    pub(super) many: &'static str,
}

/// The value of a field in a specification. A reader sets it, a writer writes it, a panel does both.
pub(crate) enum Slot<'a> {
    Number(&'a mut f64),
    /// A number that may be unknown.
    Optional(&'a mut Option<f64>),
    Text(&'a mut String),
    Flag(&'a mut bool),
    Pairs(&'a mut Vec<[f64; 2]>),
    Triples(&'a mut Vec<[f64; 3]>),
    Width(&'a mut TurningWidth),
    Slope(&'a mut EndSlope),
    Faces(&'a mut Faces),
}

/// Finds a field's value; `None` if a plate of this kind has no such field.
pub(super) type At = fn(&mut PlateSpec) -> Option<Slot<'_>>;

/// A field without a value of its own: a section's kind, a section, or a band.
pub(super) const NOWHERE: At = |_| None;

/// One field of a plate file.
pub struct Field {
    pub(crate) name: &'static str,
    pub(crate) field_type: FieldType,
    pub(crate) meaning: &'static str,
    /// The number of a file that leaves the field out; `None` if it must be there, or may be unknown.
    pub(crate) default: Option<f64>,
    /// Its caption and unit in a panel and in messages there; `None` if panels name it as the file does.
    pub caption: Option<Caption>,
    pub(super) at: At,
}

impl Field {
    pub(crate) fn slot<'a>(&self, spec: &'a mut PlateSpec) -> Option<Slot<'a>> {
        (self.at)(spec)
    }

    /// The number of this field; `None` if it is not a number, or if the plate does not have or state it.
    pub fn number_of<'a>(&self, spec: &'a mut PlateSpec) -> Option<&'a mut f64> {
        match self.slot(spec)? {
            Slot::Number(number) => Some(number),
            Slot::Optional(number) => number.as_mut(),
            _ => None,
        }
    }
}

/// Makes the part of a specification that a section describes, with the alternatives that the fields of the file select: the
/// argument says whether the file has a field. The fields' values are read into it afterwards.
pub(crate) type Begin = fn(&mut PlateSpec, &dyn Fn(&str) -> bool);

/// One kind of a section. A section without kinds has a single one, without a word.
pub(crate) struct Kind {
    /// Its word in the file.
    pub(crate) word: &'static str,
    /// The names of its fields, in the order of a written file; all of the section's if there are none here.
    pub(crate) fields: &'static [&'static str],
    /// Whether a plate is of this kind.
    pub(crate) is: fn(&PlateSpec) -> bool,
    pub(crate) begin: Begin,
}

/// A section of the file. The fields above the first section header form a section with an empty name.
pub(crate) struct Section {
    pub(crate) name: &'static str,
    pub(crate) meaning: &'static str,
    /// The field that selects the kind; empty if the section has no kinds.
    pub(crate) kind_field: &'static str,
    pub(crate) kinds: &'static [Kind],
    /// A kind that a user may look for here, and why it is missing; both empty if there is none.
    pub(crate) not_a_kind: (&'static str, &'static str),
    pub(crate) fields: &'static [Field],
}

/// The fields of a section, a row each: its name, its type and range, and its meaning; in brackets its caption and unit in a
/// panel; in parentheses its default; in braces the part of the specification that has it, with the patterns that find it there.
macro_rules! fields {
    ($spec:ident: $($name:ident: $field_type:expr, $meaning:literal
        $([$caption:literal, $unit:expr])? $((or $default:expr))? $({ $place:expr, $($found:pat => $slot:expr),+ })? ;)*) => {
        &[$(Field {
            name: stringify!($name),
            field_type: $field_type,
            meaning: $meaning,
            caption: [$(Some(Caption { name: $caption, unit: $unit }),)? None][0],
            default: [$(Some($default),)? None][0],
            at: {
                // `Some`, so that a pattern that every plate matches leaves the last arm its use.
                let found: &[At] = &[
                    $(|$spec| match Some(&mut $place) { $(Some($found) => Some($slot),)+ _ => None },)?
                    NOWHERE,
                ];
                found[0]
            },
        },)*]
    };
}

/// The kinds of a section, a row each: its word, the names of its fields in the order of a written file, in braces the part of the
/// specification and its pattern there, and that part before its fields are read.
macro_rules! kinds {
    ($spec:ident, $has:ident: $($word:literal [$($field:ident)*] { $place:expr, $is:pat } = $begin:expr;)*) => {
        &[$(Kind {
            word: $word,
            fields: &[$(stringify!($field)),*],
            is: |$spec| match &$place {
                $is => true,
                _ => false,
            },
            begin: |$spec, $has| {
                let _ = $has;
                $place = $begin;
            },
        },)*]
    };
}

pub(super) use {fields, kinds};

/// No kind that a user may look for without finding it.
pub(super) const NONE: (&str, &str) = ("", "");

impl Section {
    /// The field of that name.
    pub(crate) fn field(&self, name: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// The fields of a kind, in the order of a written file.
    pub(crate) fn fields_of(&self, kind: &Kind) -> impl Iterator<Item = &'static Field> {
        let all = if kind.fields.is_empty() { self.fields } else { &[] };
        all.iter().chain(kind.fields.iter().filter_map(|name| self.field(name)))
    }

    /// The kind that a plate has; `None` if it does not have the section.
    pub(crate) fn kind_of(&self, spec: &PlateSpec) -> Option<&'static Kind> {
        self.kinds.iter().find(|kind| (kind.is)(spec))
    }

    /// The field's name in a message: `taper.kind`.
    pub(crate) fn path(&self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}.{name}", self.name) }
    }

    /// The allowed values of a field, as a phrase that follows "must be".
    pub(crate) fn allowed(&self, field: &Field) -> Cow<'static, str> {
        match &field.field_type {
            FieldType::Number(range) => format!("a number, {range}").into(),
            FieldType::NumberThat(words) => format!("a number, {words}").into(),
            FieldType::Text(Count { least: 0, most, of }) => {
                format!("a text in quotes, up to {most} {of}").into()
            }
            FieldType::Text(count) => format!("a text in quotes, {}", count.with_unit()).into(),
            FieldType::Flag => "true or false".into(),
            FieldType::Points(Columns { points, many, .. }) => format!("{points} {many}").into(),
            FieldType::Kind => self.one_of().into(),
            FieldType::OneOf(words) => one_of(words.iter().copied()).into(),
            FieldType::Section => format!("a section [{}]", self.path(field.name)).into(),
        }
    }

    /// `one of "force", "displacement"`.
    pub(crate) fn one_of(&self) -> String {
        one_of(self.kinds.iter().map(|kind| kind.word))
    }
}

fn one_of<'w>(words: impl Iterator<Item = &'w str>) -> String {
    let words: Vec<String> = words.map(|word| format!("\"{word}\"")).collect();
    format!("one of {}", words.join(", "))
}
