//! The serde form of a text that is part of the program, such as the name of a field in an error.
//!
//! A text that is read is leaked once, so that it lives as long as the program. There are as many of them as the
//! program has names; what sends others is refused.

use serde::de::Error as _;
use serde::{Deserialize as _, Deserializer, Serializer};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// More texts than the program has names of fields.
const TEXTS: usize = 1024;
/// Longer than any of them, in bytes.
const LENGTH: usize = 1024;

static KNOWN: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// Writes the text.
///
/// # Errors
/// The serialiser's error.
pub fn serialize<S: Serializer>(text: &&'static str, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(text)
}

/// Reads a text.
///
/// # Errors
/// The deserialiser's error; or the text is longer than 1024 bytes, or the 1025th different one.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<&'static str, D::Error> {
    let text = Cow::<'de, str>::deserialize(deserializer)?;
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(text) = known.get(text.as_ref()) {
        return Ok(text);
    }
    if text.len() > LENGTH || known.len() == TEXTS {
        return Err(D::Error::custom("a text that is no part of this program"));
    }
    let text: &'static str = Box::leak(text.into_owned().into_boxed_str());
    known.insert(text);
    Ok(text)
}

#[cfg(test)]
mod tests {
    use crate::quantity::{OutOfRange, Range};

    fn sent(field: &'static str) -> Result<OutOfRange, postcard::Error> {
        let refused = OutOfRange { field, value: 2.0, range: Range::new(0.0, 1.0, "m") };
        postcard::from_bytes(&postcard::to_extend(&refused, Vec::new()).unwrap())
    }

    #[test]
    fn a_text_of_the_program_is_leaked_once_and_a_text_of_no_program_never() {
        let [one, two] = [sent("a field of this test"), sent("a field of this test")].map(Result::unwrap);
        assert!(std::ptr::eq(one.field, two.field));
        assert!(sent(String::leak("x".repeat(1025))).is_err());
    }
}
