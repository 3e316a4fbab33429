//! A plate of your own, from the text of a plate file; every error names the line, the field and its range.
//!
//! `cargo run -p slipline-plate --example own_plate`

use slipline_plate::Plate;
use std::error::Error;

const TEXT: &str = r#"
name = "my membrane"
length_m = 0.3
loss_factor = 0.01
band_start_hz = 90.0
band_end_hz = 200.0

[taper]
kind = "exponential"
half_width_m = 0.05
rate_per_m = 4.62

[model]
kind = "membrane"
wave_speed_m_per_s = 12.0

[drive]
end = "displacement"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let plate = Plate::from_toml(TEXT)?;
    let (start_m, end_m) = plate.span_m();
    println!("{}: boundaries from {:.1} to {:.1} mm", plate.name(), start_m * 1e3, end_m * 1e3);

    let too_long = TEXT.replace("length_m = 0.3", "length_m = 30");
    if let Err(error) = Plate::from_toml(&too_long) {
        println!("refused: {error}");
    }
    Ok(())
}
