//! Non-negative least squares and the least largest error, for other programs: `tests/oracle` compares them with
//! scipy's.
//!
//! Standard input, problems as numbers separated by white space: rows, columns, A column by column, b. Standard
//! output, one line for each problem: x of the least squares, then the least largest error.

use slipline_plate::texture::least_largest_error;
use slipline_plate::texture::nnls::{Columns, non_negative_least_squares};
use std::io::{self, Read, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut text = String::new();
    io::stdin().read_to_string(&mut text)?;
    let mut words = text.split_whitespace();
    let mut out = io::BufWriter::new(io::stdout().lock());
    while let Some(rows) = words.next() {
        let rows: usize = rows.parse()?;
        let count: usize = words.next().ok_or("the number of columns is missing")?.parse()?;
        let mut numbers = |count: usize| {
            let found: Result<Vec<f64>, _> = words.by_ref().take(count).map(str::parse).collect();
            found.ok().filter(|found| found.len() == count).ok_or("numbers are missing")
        };
        let mut a = Columns::new(rows);
        for _ in 0..count {
            a.push(numbers(rows)?);
        }
        let b = numbers(rows)?;
        for x in non_negative_least_squares(&a, &b) {
            write!(out, "{x:e} ")?;
        }
        let (error, _) = least_largest_error(&a, &b).ok_or("the linear program has no solution")?;
        writeln!(out, "{error:e}")?;
    }
    Ok(())
}
