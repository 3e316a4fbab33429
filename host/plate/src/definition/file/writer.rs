//! Writes a plate as TOML text.

use crate::definition::air::Faces;
use crate::definition::fields::{DRIVE, MODEL, PLATE, SECTIONS, Section, Slot, TAPER};
use crate::definition::plate::Plate;
use crate::definition::spec::PlateSpec;
use serde::ser::{Serialize, SerializeMap, Serializer};

impl Plate {
    /// The plate as TOML text that [`Plate::from_toml`] reads back to the same plate.
    pub fn to_toml(&self) -> String {
        for required in [&TAPER, &MODEL, &DRIVE] {
            debug_assert!(
                required.kind_of(self.spec()).is_some(),
                "a kind of [{}] without a row",
                required.name
            );
        }
        // A section holds only strings, numbers and lists of numbers, which TOML can always represent.
        toml::to_string(&Written { schema: &PLATE, spec: self.spec() }).unwrap_or_default()
    }
}

/// A section of a plate, with the sections within it.
struct Written<'a> {
    schema: &'static Section,
    spec: &'a PlateSpec,
}

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { schema, spec } = *self;
        let mut map = serializer.serialize_map(None)?;
        if let Some(kind) = schema.kind_of(spec) {
            if !schema.kind_field.is_empty() {
                map.serialize_entry(schema.kind_field, kind.word)?;
            }
            // A slot is where a value is changed, too: it needs a specification of its own.
            let mut own = spec.clone();
            for field in schema.fields_of(kind) {
                field.slot(&mut own).map_or(Ok(()), |slot| write(&mut map, field.name, slot))?;
            }
        }
        for inner in SECTIONS.into_iter().filter(|inner| inner.kind_of(spec).is_some()) {
            let (outer, name) = inner.name.rsplit_once('.').unwrap_or(("", inner.name));
            if outer == schema.name && !name.is_empty() {
                map.serialize_entry(name, &Written { schema: inner, spec })?;
            }
        }
        map.end()
    }
}

fn write<M: SerializeMap>(map: &mut M, name: &str, slot: Slot<'_>) -> Result<(), M::Error> {
    match slot {
        Slot::Number(number) => map.serialize_entry(name, number),
        Slot::Optional(number) => number.map_or(Ok(()), |number| map.serialize_entry(name, &number)),
        Slot::Text(text) => map.serialize_entry(name, text),
        Slot::Flag(flag) => map.serialize_entry(name, flag),
        Slot::Pairs(points) => map.serialize_entry(name, points),
        Slot::Triples(points) => map.serialize_entry(name, points),
        Slot::Width(width) => map.serialize_entry(name, width.word()),
        Slot::Slope(slope) => map.serialize_entry(name, slope.word()),
        Slot::Faces(Faces::One) => map.serialize_entry(name, &1),
        Slot::Faces(Faces::Two) => map.serialize_entry(name, &2),
    }
}
