//! The check of a count, a time or a sample index in a command.

use slipline_protocol::refusal::{Field, Refusal};

/// Refuses a value outside its limits, both allowed.
pub(crate) fn within<T: Into<u64>>(field: Field, (min, max): (T, T), got: T) -> Result<(), Refusal> {
    in_range(field, min.into(), max.into(), got.into())
}

/// Refuses a value outside `min..=max`.
pub(crate) fn in_range(field: Field, min: u64, max: u64, got: u64) -> Result<(), Refusal> {
    if (min..=max).contains(&got) {
        return Ok(());
    }
    // An index beyond 2^63 is 730 000 years away.
    let signed = |value| i64::try_from(value).unwrap_or(i64::MAX);
    Err(Refusal::out_of_range(field, signed(min), signed(max), signed(got)))
}
