//! Reads a plate's TOML text field by field and finds the line of each field for error messages.

use crate::definition::air::Faces;
use crate::definition::error::{PlateError, PlateFileError};
use crate::definition::fields::{Field, FieldType, Kind, SECTIONS, Section, Slot};
use crate::definition::source::EndSlope;
use crate::definition::spec::PlateSpec;
use crate::definition::turning_width::TurningWidth;
use crate::quantity::number_format::typed;
use crate::quantity::{hint, must_be, nearest};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Largest number of characters that a message quotes from a file, because a hostile file may hold very long names
/// and values.
const QUOTED: usize = 40;

/// The parsed text.
pub(super) struct Text<'t> {
    text: &'t str,
    root: DeTable<'t>,
}

/// One section of the text. All its keys are fields of the section's kind.
pub(super) struct Given<'a> {
    text: &'a str,
    schema: &'static Section,
    table: &'a DeTable<'a>,
    kind: &'static Kind,
    /// Numbers that take the place of the text's.
    changes: &'a [(&'a str, f64)],
}

impl<'t> Text<'t> {
    pub(super) fn parse(text: &'t str) -> Result<Self, PlateFileError> {
        match DeTable::parse(text) {
            Ok(root) => Ok(Self { text, root: root.into_inner() }),
            Err(fault) => {
                let line = fault.span().map_or(1, |span| line_at(text, span.start));
                Err(PlateFileError::Syntax {
                    line,
                    message: syntax_message(text, line, fault.message().trim()),
                })
            }
        }
    }

    /// Line of the field, or of its section's header if the field is absent; counted from 1.
    pub(super) fn line_of(&self, field: &str) -> Option<usize> {
        // `taper.points[2][0]` is a field, `[tapper]` a section.
        let field = field.strip_prefix('[').map_or(field, |section| section.trim_end_matches(']'));
        let (path, indices) = field.split_once('[').unwrap_or((field, ""));
        let mut table = &self.root;
        let mut found: Option<Range<usize>> = None;
        for name in path.split('.') {
            let Some((key, value)) = entry(table, name) else { break };
            found = Some(key.span());
            match value.get_ref() {
                DeValue::Table(inner) => table = inner,
                DeValue::Array(points) => {
                    let index = indices.split(']').next().and_then(|index| index.parse::<usize>().ok());
                    if let Some(point) = index.and_then(|index| points.get(index)) {
                        found = Some(point.span());
                    }
                    break;
                }
                _ => break,
            }
        }
        found.map(|span| line_at(self.text, span.start))
    }

    /// Whether the plate itself has a field or a section of that name.
    pub(super) fn has(&self, name: &str) -> bool {
        entry(&self.root, name).is_some()
    }

    /// The section as the file gives it, with `changes` of numbers by the paths of their fields; `None` if it is absent.
    /// Refuses unknown fields and fields of other kinds.
    pub(super) fn section<'a>(
        &'a self,
        schema: &'static Section,
        changes: &'a [(&'a str, f64)],
    ) -> Result<Option<Given<'a>>, PlateError> {
        let mut table = &self.root;
        let mut path = String::new();
        // `drive.lead_in` is a section within a section.
        for name in schema.name.split('.').filter(|name| !name.is_empty()) {
            path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
            let Some((_, value)) = entry(table, name) else { return Ok(None) };
            let DeValue::Table(inner) = value.get_ref() else {
                return Err(wrong_type(
                    &path,
                    quoted(self.text, value.span()),
                    format!("a section [{path}]"),
                ));
            };
            table = inner;
        }
        let mut given = Given { text: self.text, schema, table, kind: &schema.kinds[0], changes };
        given.refuse_unknown(|_| true)?;
        given.kind = given.find_kind()?;
        if !schema.kind_field.is_empty() {
            let fields = given.kind.fields;
            // A subsection is judged by its own reader, which knows why it does not belong to a kind.
            let is_section = |name: &str| {
                schema.field(name).is_some_and(|field| matches!(field.field_type, FieldType::Section))
            };
            given.refuse_unknown(|name| {
                name == schema.kind_field || fields.contains(&name) || is_section(name)
            })?;
        }
        Ok(Some(given))
    }
}

impl<'a> Given<'a> {
    /// Refuses the first key in the text that is not a field of this section, or for which `has` is false.
    fn refuse_unknown(&self, has: impl Fn(&str) -> bool) -> Result<(), PlateError> {
        let is_section = |name: &str| {
            self.schema.name.is_empty()
                && SECTIONS.iter().any(|section| section.name == name && !name.is_empty())
        };
        let unknown = self
            .table
            .iter()
            .filter(|(key, _)| {
                let name = key.get_ref().as_ref();
                !is_section(name) && (self.schema.field(name).is_none() || !has(name))
            })
            .min_by_key(|(key, _)| key.span().start);
        let Some((key, value)) = unknown else { return Ok(()) };
        let name: String = printable(key.get_ref()).take(QUOTED).collect();
        if self.schema.field(&name).is_some() {
            let Kind { word, fields, .. } = self.kind;
            let has = if fields.is_empty() { "no other field".to_owned() } else { fields.join(", ") };
            let reason = format!("\"{word}\" has {has}");
            return Err(PlateError::Unexpected { field: self.schema.path(&name), reason });
        }
        if value.get_ref().is_table() {
            let sections = || SECTIONS.iter().map(|section| section.name).filter(|name| !name.is_empty());
            let reason = nearest(&name, sections()).map_or_else(
                || {
                    "the sections of a plate are [taper], [model], [drive], [air], [frame] and [actuator]"
                        .to_owned()
                },
                |near| format!("did you mean [{near}]?"),
            );
            return Err(PlateError::Unexpected { field: format!("[{}]", self.schema.path(&name)), reason });
        }
        let names = || self.schema.fields.iter().map(|field| field.name);
        let home = SECTIONS.iter().find(|section| section.field(&name).is_some());
        let reason = match (home, nearest(&name, names())) {
            (Some(home), _) if home.name.is_empty() => {
                "it is a field of the plate itself: write it above the first [section]".to_owned()
            }
            (Some(home), _) => format!("it is a field of [{}]", home.name),
            (None, Some(near)) => format!("did you mean {near}?"),
            (None, None) => format!("the fields here are {}", names().collect::<Vec<_>>().join(", ")),
        };
        Err(PlateError::Unexpected { field: self.schema.path(&name), reason })
    }

    /// The kind of the section.
    fn find_kind(&self) -> Result<&'static Kind, PlateError> {
        let schema = self.schema;
        if schema.kind_field.is_empty() {
            return Ok(self.kind);
        }
        let field = schema.path(schema.kind_field);
        let Some((_, value)) = entry(self.table, schema.kind_field) else {
            return Err(PlateError::Missing {
                field,
                needed: format!("{}, {}", schema.meaning, schema.one_of()),
            });
        };
        let word = value.get_ref().as_str().unwrap_or_default();
        schema.kinds.iter().find(|kind| kind.word == word).ok_or_else(|| {
            let meant = hint(word, schema.kinds.iter().map(|kind| kind.word));
            let (not_a_kind, reason) = schema.not_a_kind;
            let meant = if word == not_a_kind { format!("; {reason}") } else { meant };
            let allowed = format!("{}{meant}", schema.one_of());
            wrong_type(&field, quoted(self.text, value.span()), allowed)
        })
    }

    fn value(&self, name: &str) -> Option<(&'static Field, &'a Spanned<DeValue<'a>>)> {
        let field = self.schema.field(name)?;
        entry(self.table, name).map(|(_, value)| (field, value))
    }

    /// The name of the section.
    pub(super) fn name(&self) -> &'static str {
        self.schema.name
    }

    /// Whether the field was given.
    pub(super) fn has(&self, name: &str) -> bool {
        entry(self.table, name).is_some()
    }

    /// The error for a field that is absent.
    pub(super) fn missing(&self, name: &str) -> PlateError {
        let allowed = self
            .schema
            .field(name)
            .map_or_else(String::new, |field| format!("{}, {}", field.meaning, self.schema.allowed(field)));
        let word = self.kind.word;
        let needed = if word.is_empty() { allowed } else { format!("\"{word}\" needs it: {allowed}") };
        PlateError::Missing { field: self.schema.path(name), needed }
    }

    fn read<T>(
        &self,
        name: &str,
        take: impl FnOnce(&'a DeValue<'a>) -> Option<T>,
    ) -> Result<Option<T>, PlateError> {
        let Some((field, value)) = self.value(name) else { return Ok(None) };
        take(value.get_ref()).map(Some).ok_or_else(|| {
            let found = quoted(self.text, value.span());
            wrong_type(&self.schema.path(name), found, self.schema.allowed(field).into_owned())
        })
    }

    /// An optional number.
    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, PlateError> {
        let given = self.read(name, as_number)?;
        Ok(given.map(|number| self.changed(name).unwrap_or(number)))
    }

    fn changed(&self, name: &str) -> Option<f64> {
        let is_here = |path: &str| match path.rsplit_once('.') {
            Some((section, field)) => section == self.schema.name && field == name,
            None => self.schema.name.is_empty() && path == name,
        };
        self.changes.iter().find(|(path, _)| is_here(path)).map(|(_, number)| *number)
    }

    /// The numbers of this section, each with the path of its field.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (String, f64)> {
        let is_number =
            |field: &&Field| matches!(field.field_type, FieldType::Number(_) | FieldType::NumberThat(_));
        let fields = self.schema.fields.iter().filter(is_number);
        fields.filter_map(|field| Some((self.schema.path(field.name), self.number(field.name).ok()??)))
    }

    /// Reads the section's fields into a specification.
    pub(super) fn read_into(&self, spec: &mut PlateSpec) -> Result<(), PlateError> {
        (self.kind.begin)(spec, &|name| self.has(name));
        for field in self.schema.fields_of(self.kind) {
            let name = field.name;
            let Some(slot) = field.slot(spec) else { continue };
            match slot {
                Slot::Number(number) => {
                    *number = self.number(name)?.or(field.default).ok_or_else(|| self.missing(name))?;
                }
                Slot::Optional(number) => *number = self.number(name)?,
                Slot::Text(text) => {
                    *text = self.read(name, |value| value.as_str().map(str::to_owned))?.unwrap_or_default();
                }
                Slot::Flag(flag) => *flag = self.read(name, DeValue::as_bool)?.unwrap_or_default(),
                Slot::Pairs(points) => *points = self.points(name)?,
                Slot::Triples(points) => *points = self.points(name)?,
                Slot::Width(width) => {
                    let word = self.word(name)?;
                    *width =
                        TurningWidth::ALL.into_iter().find(|it| word == Some(it.word())).unwrap_or(*width);
                }
                Slot::Slope(slope) => {
                    let word = self.word(name)?;
                    *slope = EndSlope::ALL.into_iter().find(|it| word == Some(it.word())).unwrap_or(*slope);
                }
                Slot::Faces(faces) => *faces = self.faces(name)?,
            }
        }
        Ok(())
    }

    fn faces(&self, name: &str) -> Result<Faces, PlateError> {
        match self.number(name)? {
            None => Ok(Faces::default()),
            Some(1.0) => Ok(Faces::One),
            Some(2.0) => Ok(Faces::Two),
            Some(count) => Err(wrong_type(&self.schema.path(name), typed(count), "1 or 2".to_owned())),
        }
    }

    /// One of a few words; `None` if it is absent.
    fn word(&self, name: &str) -> Result<Option<&'static str>, PlateError> {
        let Some((Field { field_type: FieldType::OneOf(words), .. }, _)) = self.value(name) else {
            return Ok(None);
        };
        self.read(name, |value| words.iter().copied().find(|word| value.as_str() == Some(word)))
    }

    /// Points of `N` numbers each.
    fn points<const N: usize>(&self, name: &str) -> Result<Vec<[f64; N]>, PlateError> {
        let points = self.read(name, DeValue::as_array)?.ok_or_else(|| self.missing(name))?;
        let one = match self.schema.field(name).map(|field| &field.field_type) {
            Some(FieldType::Points(columns)) => columns.one,
            _ => "",
        };
        points
            .iter()
            .enumerate()
            .map(|(index, point)| {
                let numbers: Option<Vec<f64>> = point
                    .get_ref()
                    .as_array()
                    .and_then(|row| row.iter().map(|value| as_number(value.get_ref())).collect());
                numbers.and_then(|row| row.try_into().ok()).ok_or_else(|| {
                    let field = format!("{}[{index}]", self.schema.path(name));
                    wrong_type(&field, quoted(self.text, point.span()), one.to_owned())
                })
            })
            .collect()
    }
}

fn entry<'m, 't>(
    table: &'m DeTable<'t>,
    name: &str,
) -> Option<(&'m Spanned<std::borrow::Cow<'t, str>>, &'m Spanned<DeValue<'t>>)> {
    table.iter().find(|(key, _)| key.get_ref() == name)
}

/// A finite number from a float or an integer in any base; `inf` and `nan` pass, so that the range check reports
/// them. A literal too large for `f64` is `None`: as infinity it would be quoted wrongly.
fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => {
            let number: f64 = float.as_str().parse().ok()?;
            (!number.is_infinite() || float.as_str().contains("inf")).then_some(number)
        }
        DeValue::Integer(integer) if integer.radix() == 10 => {
            integer.as_str().parse().ok().filter(|number: &f64| number.is_finite())
        }
        DeValue::Integer(integer) => {
            u64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|number| number as f64)
        }
        _ => None,
    }
}

/// The characters of a text that may go to a terminal: a control character could move its cursor or hide the message.
fn printable(text: &str) -> impl Iterator<Item = char> {
    text.chars().map(|letter| if letter.is_control() { char::REPLACEMENT_CHARACTER } else { letter })
}

/// The text at `span` for a message: its first line, at most [`QUOTED`] characters, with `…` if something is cut off.
fn quoted(text: &str, span: Range<usize>) -> String {
    let given = text.get(span).unwrap_or_default();
    let first = given.lines().next().unwrap_or_default();
    let beginning: String = printable(first).take(QUOTED).collect();
    if beginning.len() == given.len() { beginning } else { format!("{beginning}…") }
}

fn wrong_type(field: &str, value: String, allowed: String) -> PlateError {
    PlateError::UnknownKind { field: field.to_owned(), value, allowed }
}

/// Line of byte `offset`, from 1.
fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// The parser's message, preceded by the name of the field on that line. If the value itself cannot be parsed, the
/// message also says what the field must be.
fn syntax_message(text: &str, line: usize, sentence: &str) -> String {
    let header = |line: &str| Some(line.trim().strip_prefix('[')?.split(']').next()?.trim().to_owned());
    let section = text.lines().take(line).filter_map(header).last().unwrap_or_default();
    let here = text.lines().nth(line - 1).unwrap_or_default();
    let known = here.split_once('=').and_then(|(key, _)| {
        let schema = *SECTIONS.iter().find(|schema| schema.name == section)?;
        schema.field(key.trim()).map(|field| (schema, field))
    });
    match known {
        Some((schema, field)) if DeTable::parse(here).is_err() => {
            let value = here.split_once('=').map_or("", |(_, value)| value).trim();
            let value = quoted(value, 0..value.len());
            let point = if matches!(field.field_type, FieldType::Number(_) | FieldType::NumberThat(_)) {
                " with a decimal point and no unit"
            } else {
                ""
            };
            let allowed = schema.allowed(field).replacen("a number", &format!("a number{point}"), 1);
            must_be(
                format_args!("{} = {value}", schema.path(field.name)),
                format_args!("{allowed} ({sentence})"),
            )
        }
        Some((schema, field)) => format!("{}: {sentence}", schema.path(field.name)),
        None => sentence.to_owned(),
    }
}
