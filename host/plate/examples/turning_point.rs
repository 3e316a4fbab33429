//! Turning point of a frequency on a plate, and the width of its edge.
//!
//! `cargo run -p slipline-plate --example turning_point`

use slipline_plate::preset;

fn main() {
    let Some(plate) = preset("membrane") else { return };
    let (low, high) = plate.band_hz();
    println!("{}: {low:.1} to {high:.1} Hz", plate.name());
    for i in 0..=4 {
        let frequency_hz = low * (high / low).powf(f64::from(i) / 4.0);
        let turning_point = plate.turning_point_m(frequency_hz).zip(plate.edge_width_m(frequency_hz));
        if let Some((place_m, width_m)) = turning_point {
            println!(
                "{frequency_hz:8.1} Hz turns at {:6.1} mm, edge {:5.1} mm",
                place_m * 1e3,
                width_m * 1e3
            );
        }
    }
}
