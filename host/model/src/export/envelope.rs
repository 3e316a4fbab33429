//! The envelope over x as a picture: what the frequency domain says, what the simulated plate did, and where each
//! tone's boundary is.

use crate::field::simulation::Simulated;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::io::Write;

/// Pixels, wide and high.
const SIZE: (u32, u32) = (1280, 640);
const FONT: &str = "slipline-envelope";
// Colours that stay apart for colour-blind readers (Okabe and Ito).
const PREDICTED: RGBColor = RGBColor(0, 114, 178);
const MEASURED: RGBColor = RGBColor(213, 94, 0);
const BOUNDARY: RGBColor = RGBColor(90, 90, 90);

/// Writes the picture as PNG.
///
/// # Errors
/// What the canvas or the writer says.
pub fn png(result: &Simulated, plate: &str, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut rgb = vec![255; (SIZE.0 * SIZE.1 * 3) as usize];
    draw(result, plate, &mut rgb)?;
    let mut encoder = png::Encoder::new(out, SIZE.0, SIZE.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    Ok(writer.finish()?)
}

fn draw(result: &Simulated, plate: &str, rgb: &mut [u8]) -> anyhow::Result<()> {
    // Known already is as good as made known now.
    register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| anyhow::anyhow!("the embedded font cannot be read"))?;
    let in_mm = |x_m: f64| x_m * 1e3;
    // The RMS of a settled tone is its amplitude over the root of two: one measure for one tone or many.
    let in_um = |rms_m: f64| rms_m * 1e6;
    let measured: Vec<(f64, f64)> = result
        .position_m
        .iter()
        .zip(&result.rms_m)
        .map(|(&x_m, &rms_m)| (in_mm(x_m), in_um(f64::from(rms_m))))
        .collect();
    let predicted: Vec<(f64, f64)> = result
        .position_m
        .iter()
        .zip(&result.predicted_rms_m)
        .map(|(&x_m, &rms_m)| (in_mm(x_m), in_um(rms_m)))
        .collect();
    let length_mm = measured.last().map_or(1.0, |&(x_mm, _)| x_mm);
    let highest_um = measured.iter().chain(&predicted).map(|&(_, um)| um).fold(0.0, f64::max);
    let top_um = if highest_um > 0.0 { 1.08 * highest_um } else { 1.0 };

    let canvas = BitMapBackend::with_buffer(rgb, SIZE).into_drawing_area();
    canvas.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&canvas)
        .caption(format!("{plate}: RMS displacement along the plate"), (FONT, 24))
        .margin(16)
        .x_label_area_size(48)
        .y_label_area_size(80)
        .build_cartesian_2d(0.0..length_mm, 0.0..top_um)?;
    chart
        .configure_mesh()
        .x_desc("x from the driven end (mm)")
        .y_desc("RMS (µm)")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| if top_um < 1.0 { format!("{y:.3}") } else { format!("{y:.1}") })
        .label_style((FONT, 16))
        .axis_desc_style((FONT, 18))
        .light_line_style(WHITE)
        .draw()?;
    let boundaries = result.tones.iter().map(|tone| {
        let x_mm = in_mm(tone.predicted.turning_point_m);
        PathElement::new(vec![(x_mm, 0.0), (x_mm, top_um)], BOUNDARY)
    });
    chart
        .draw_series(boundaries)?
        .label("boundary (turning point)")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 24, y)], BOUNDARY));
    chart
        .draw_series(LineSeries::new(predicted, PREDICTED.stroke_width(2)))?
        .label("frequency domain")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 24, y)], PREDICTED.stroke_width(2)));
    let marks = measured.iter().step_by(6).map(|&point| Circle::new(point, 3, MEASURED.filled()));
    chart
        .draw_series(marks)?
        .label("simulated plate")
        .legend(|(x, y)| Circle::new((x + 12, y), 3, MEASURED.filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font((FONT, 16))
        .background_style(WHITE)
        .border_style(BOUNDARY)
        .draw()?;
    canvas.present()?;
    Ok(())
}
