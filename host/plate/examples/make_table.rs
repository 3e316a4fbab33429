//! The drive table of a plate: for each place of the boundary a frequency and a gain.
//!
//! `cargo run --release -p slipline-plate --example make_table`

use slipline_plate::{DriveTable, preset};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let plate = preset("al-bending").ok_or("no such preset")?;
    let table = DriveTable::build(&plate, 400e3, 257)?;
    println!("place/mm  frequency/Hz  gain");
    for knot in table.knots.iter().step_by(32) {
        println!("{:8.1}  {:12.1}  {:.4}", knot.position_m * 1e3, knot.frequency_hz, knot.gain);
    }
    println!("the peak keeps its level within {:.2} dB", table.worst_error_db);
    Ok(())
}
