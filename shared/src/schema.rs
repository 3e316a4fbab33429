//! The schema of the messages' bodies as data, made by the same macros that make the types.
//!
//! ```text
//! body! { struct }   choices! { enum }   messages! { commands, events }
//!    |                  |                   |
//!    +--> the type, its encoding by postcard, its lowering to an older minor
//!    +--> a [`Shape`]: PROTOCOL.md is written from it, and a test reads every golden frame by it alone
//! ```
//! A body never changes within a major version. What is new comes as a new message or as a new variant at the end of
//! an enumeration, and says since which minor it stands; [`Wire::lowered`] replaces it for an older one.

use crate::minor::Minor;
use heapless::{String, Vec};

/// The encoding of a value on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One byte.
    U8,
    /// A varint of up to 16 bits.
    U16,
    /// A varint of up to 32 bits.
    U32,
    /// A varint of up to 64 bits.
    U64,
    /// A zigzag varint of up to 16 bits.
    I16,
    /// A zigzag varint of up to 64 bits.
    I64,
    /// One byte, 0 or 1.
    Bool,
    /// One byte, 0 or 1; after a 1 the value.
    Option(&'static Self),
    /// This number of values, without a count.
    Array(usize, &'static Self),
    /// The count as a varint, at most this, and then the values.
    List(usize, &'static Self),
    /// The length in bytes as a varint, at most this, and then UTF-8.
    Text(usize),
    /// The fields of a type, in order.
    Struct(&'static str, &'static [FieldRow]),
    /// The variant's number as a varint, and then what it carries.
    Enum(&'static str, &'static [VariantRow]),
}

/// A field of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldRow {
    /// Its name.
    pub name: &'static str,
    /// What it means; one string for each line.
    pub doc: &'static [&'static str],
    /// Its unit; empty for numbers without one.
    pub unit: &'static str,
    /// The lowest and the highest allowed value, where that is less than the type can hold.
    pub range: Option<(i64, i64)>,
    /// Its encoding.
    pub shape: &'static Shape,
}

/// A variant of an enumeration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VariantRow {
    /// Its number on the wire.
    pub number: u8,
    /// The minor version that brought it.
    pub since: u8,
    /// Its name.
    pub name: &'static str,
    /// What it means; one string for each line.
    pub doc: &'static [&'static str],
    /// What it carries.
    pub fields: &'static [FieldRow],
}

/// A message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageRow {
    /// Its id.
    pub id: u8,
    /// The minor version that brought it.
    pub since: u8,
    /// Its name.
    pub name: &'static str,
    /// What it means; one string for each line.
    pub doc: &'static [&'static str],
    /// Its body; `None` if it is empty.
    pub body: Option<&'static Shape>,
    /// For a command, the event that answers it when it is not refused.
    pub answer: Option<&'static str>,
}

/// A type that may stand in a body.
pub trait Wire: Sized {
    /// Its encoding.
    const SHAPE: &'static Shape;

    /// The same for a side that speaks an older minor: what is newer is replaced by what that side knows.
    #[must_use]
    fn lowered(&self, minor: Minor) -> Self;
}

/// Numbers are the same in every minor.
macro_rules! number {
    ($($number:ty: $shape:ident),+) => { $(
        impl Wire for $number {
            const SHAPE: &'static Shape = &Shape::$shape;

            fn lowered(&self, _: Minor) -> Self {
                *self
            }
        }
    )+ };
}
number!(u8: U8, u16: U16, u32: U32, u64: U64, i16: I16, i64: I64, bool: Bool);

/// A type that stands on the wire as the one it holds.
macro_rules! transparent {
    ($($name:ident($inner:ty)),+) => { $(
        impl $crate::schema::Wire for $name {
            const SHAPE: &'static $crate::schema::Shape = <$inner as $crate::schema::Wire>::SHAPE;

            fn lowered(&self, minor: $crate::minor::Minor) -> Self {
                Self(self.0.lowered(minor))
            }
        }
    )+ };
}
pub(crate) use transparent;

impl<T: Wire> Wire for Option<T> {
    const SHAPE: &'static Shape = &Shape::Option(T::SHAPE);

    fn lowered(&self, minor: Minor) -> Self {
        self.as_ref().map(|value| value.lowered(minor))
    }
}

impl<T: Wire, const N: usize> Wire for [T; N] {
    const SHAPE: &'static Shape = &Shape::Array(N, T::SHAPE);

    fn lowered(&self, minor: Minor) -> Self {
        self.each_ref().map(|value| value.lowered(minor))
    }
}

impl<T: Wire, const N: usize> Wire for Vec<T, N> {
    const SHAPE: &'static Shape = &Shape::List(N, T::SHAPE);

    fn lowered(&self, minor: Minor) -> Self {
        self.iter().map(|value| value.lowered(minor)).collect()
    }
}

impl<const N: usize> Wire for String<N> {
    const SHAPE: &'static Shape = &Shape::Text(N);

    fn lowered(&self, _: Minor) -> Self {
        self.clone()
    }
}

impl Wire for (u8, u8, u8) {
    const SHAPE: &'static Shape = &Shape::Array(3, &Shape::U8);

    fn lowered(&self, _: Minor) -> Self {
        *self
    }
}

/// One row of a body's fields.
macro_rules! field_row {
    ([$($doc:literal)+] $name:ident $ty:ty, $unit:literal $(, $min:expr, $max:expr)?) => {
        $crate::schema::FieldRow {
            name: stringify!($name),
            doc: &[$($doc),+],
            unit: $unit,
            range: $crate::schema::field_row!(@range $($min, $max)?),
            shape: <$ty as $crate::schema::Wire>::SHAPE,
        }
    };
    (@range) => { None };
    (@range $min:expr, $max:expr) => { Some(($min as i64, $max as i64)) };
}
pub(crate) use field_row;

/// Defines a body. After a field's type stand its unit and, where it has one, its range.
macro_rules! body {
    (
        $(#[doc = $doc:literal])+
        #[derive($($derive:ident),+)]
        pub struct $name:ident {
            $(
                $(#[doc = $field_doc:literal])+
                pub $field:ident: $ty:ty [$unit:literal $(, $min:expr, $max:expr)?],
            )+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive($($derive),+, serde::Serialize, serde::Deserialize)]
        pub struct $name {
            $( $(#[doc = $field_doc])+ pub $field: $ty, )+
        }

        impl $crate::schema::Wire for $name {
            const SHAPE: &'static $crate::schema::Shape = &$crate::schema::Shape::Struct(
                stringify!($name),
                &[$( $crate::schema::field_row!([$($field_doc)+] $field $ty, $unit $(, $min, $max)?) ),+],
            );

            fn lowered(&self, minor: $crate::minor::Minor) -> Self {
                Self { $( $field: $crate::schema::Wire::lowered(&self.$field, minor) ),+ }
            }
        }
    };
}
pub(crate) use body;

/// Defines an enumeration that stands in a body. A variant has a number, a minor, a name and what it carries. A variant
/// of a later minor also has an older one (`or`), which replaces it for a side that does not know it.
macro_rules! choices {
    (
        $(#[doc = $doc:literal])+
        $(#[derive($derive:ident)])?
        pub enum $name:ident {
            $(
                $(#[doc = $variant_doc:literal])+
                $(#[default $($default:ident)?])?
                $number:literal since $since:literal $variant:ident
                $({ $( $(#[doc = $field_doc:literal])+ $field:ident: $ty:ty [$unit:literal], )+ })?
                $(($inner:ty))?
                $(or $fallback:expr)?,
            )+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        $(#[derive($derive)])?
        #[repr(u8)]
        pub enum $name {
            $(
                $(#[doc = $variant_doc])+
                $(#[default $($default)?])?
                $variant $({ $( $(#[doc = $field_doc])+ $field: $ty, )+ })? $(($inner))? = $number,
            )+
        }

        impl $name {
            /// Every variant, in the order of their numbers.
            pub const ROWS: &'static [$crate::schema::VariantRow] = &[
                $(
                    $crate::schema::VariantRow {
                        number: $number,
                        since: $since,
                        name: stringify!($variant),
                        doc: &[$($variant_doc),+],
                        fields: &[
                            $($( $crate::schema::field_row!([$($field_doc)+] $field $ty, $unit) ),+)?
                            $( $crate::schema::field_row!(["What the variant carries."] value $inner, "") )?
                        ],
                    },
                )+
            ];
        }

        impl $crate::schema::Wire for $name {
            const SHAPE: &'static $crate::schema::Shape =
                &$crate::schema::Shape::Enum(stringify!($name), Self::ROWS);

            fn lowered(&self, minor: $crate::minor::Minor) -> Self {
                // Unused where no variant is newer than the first minor and none carries anything.
                let _ = minor;
                match self {
                    $(
                        $crate::schema::choices!(@pattern value $variant $({$($field)+})? $(($inner))?) => {
                            $(
                                if !minor.has($since) {
                                    return $crate::schema::Wire::lowered(&$fallback, minor);
                                }
                            )?
                            $crate::schema::choices!(@keep minor value $variant $({$($field)+})? $(($inner))?)
                        }
                    )+
                }
            }
        }

        // postcard writes a variant's place in the list: it must be its number. What is new must have a fallback.
        const _: () = {
            let mut place = 0;
            $(
                {
                    assert!($number == place && ($since == 0) != $crate::schema::choices!(@has $($fallback)?));
                    place += 1;
                }
            )+
            assert!(place > 0);
        };
    };
    (@has) => { false };
    (@has $fallback:expr) => { true };
    (@pattern $value:ident $variant:ident) => { Self::$variant };
    (@pattern $value:ident $variant:ident {$($field:ident)+}) => { Self::$variant { $($field),+ } };
    (@pattern $value:ident $variant:ident ($inner:ty)) => { Self::$variant($value) };
    (@keep $minor:ident $value:ident $variant:ident) => { Self::$variant };
    (@keep $minor:ident $value:ident $variant:ident {$($field:ident)+}) => {
        Self::$variant { $($field: $crate::schema::Wire::lowered($field, $minor)),+ }
    };
    (@keep $minor:ident $value:ident $variant:ident ($inner:ty)) => {
        Self::$variant($crate::schema::Wire::lowered($value, $minor))
    };
}
pub(crate) use choices;
