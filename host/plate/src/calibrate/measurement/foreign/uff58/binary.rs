//! Dataset 58b: the header is the text of dataset 58, and its numbers follow as bytes.
//!
//! The dataset's first line states the format: `58b`, the byte order (1: little-endian, 2: big-endian), the number
//! format (1: VAX, 2: IEEE 754, 3: IBM), the number of header lines that follow (11), and the number of bytes after
//! them. The bytes begin directly after the last header line and are in the order of the text's numbers; a line of -1
//! follows them directly.

use super::{Form, HEAD, Lines, head, is_mark, whole};
use crate::calibrate::measurement::foreign::Foreign;
use crate::quantity::must_be;
use crate::text_table::{BadLine, wrong};

/// The only number format that is read.
const IEEE_754: u32 = 2;

/// The function of a dataset with this first line, up to the line of -1 behind it.
pub(super) fn function(lines: &mut Lines<'_>, kind: &str) -> Result<Foreign, BadLine> {
    let function = numbers(lines, kind);
    while lines.next().is_some_and(|line| !is_mark(line)) {}
    function
}

fn numbers(lines: &mut Lines<'_>, kind: &str) -> Result<Foreign, BadLine> {
    let at = lines.line;
    let words: Vec<&str> = kind.split_whitespace().collect();
    let order = whole(at, "the order of the bytes", words.get(1))?;
    let is_little = match order {
        1 => true,
        2 => false,
        other => {
            let allowed = "1 (the lowest first) or 2 (the highest first)";
            return Err(wrong(at, must_be(format_args!("the order of the bytes = {other}"), allowed)));
        }
    };
    let form = whole(at, "the form of the numbers", words.get(2))?;
    if form != IEEE_754 {
        let allowed = "2: IEEE 754; save it again on another computer, or as text";
        return Err(wrong(at, must_be(format_args!("the form of the numbers = {form}"), allowed)));
    }
    let stated = whole(at, "the number of lines", words.get(3))? as usize;
    if stated != HEAD {
        return Err(wrong(at, must_be(format_args!("the number of lines = {stated}"), "11")));
    }
    let count = whole(at, "the number of bytes", words.get(4))? as usize;
    let form = Form::of(&head(lines))?;
    let data = lines.skip(count).ok_or_else(|| {
        wrong(at, format!("the file ends before the {count} bytes that the dataset declares"))
    })?;
    form.points(&values(data, &form, is_little, at)?.into_iter().map(|value| (at, value)).collect::<Vec<_>>())
}

/// The numbers of a dataset's bytes.
fn values(data: &[u8], form: &Form, is_little: bool, at: usize) -> Result<Vec<f64>, BadLine> {
    // Bytes of the abscissa and of the ordinates of a row: some programs write the abscissa in the precision of the
    // ordinates, some in single precision.
    let ordinates = form.ordinates();
    let abscissas: &[usize] = if form.is_even {
        &[0]
    } else if form.is_double {
        &[8, 4]
    } else {
        &[4]
    };
    let size = if form.is_double { 8 } else { 4 };
    let fits = |abscissa: &&usize| form.count.checked_mul(**abscissa + ordinates * size) == Some(data.len());
    let Some(&abscissa) = abscissas.iter().find(fits) else {
        let given = format_args!("the {} bytes of a dataset of {} points", data.len(), form.count);
        return Err(wrong(
            at,
            must_be(given, format_args!("{} for each point", abscissas[0] + ordinates * size)),
        ));
    };
    let number = |bytes: &[u8]| match *bytes {
        [a, b, c, d] if is_little => f64::from(f32::from_le_bytes([a, b, c, d])),
        [a, b, c, d] => f64::from(f32::from_be_bytes([a, b, c, d])),
        [a, b, c, d, e, f, g, h] if is_little => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        [a, b, c, d, e, f, g, h] => f64::from_be_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    };
    let mut values = Vec::with_capacity(data.len() / 4);
    for row in data.chunks_exact((abscissa + ordinates * size).max(1)) {
        let (first, rest) = row.split_at(abscissa);
        values.extend((abscissa > 0).then(|| number(first)));
        values.extend(rest.chunks_exact(size).map(number));
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => {
            let given = format_args!("number {} of the dataset's bytes = {}", place + 1, values[place]);
            Err(wrong(at, must_be(given, "a finite number: is the order of the bytes right?")))
        }
        None => Ok(values),
    }
}

#[cfg(test)]
mod tests;
