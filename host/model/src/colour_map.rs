//! Colour maps of displacement and amplitude, for the screen and for print.
//!
//! Lightness in OKLab is linear in the value, so that equal steps of the value look like equal steps. The hues are
//! blue and orange (signed) or blue and yellow (amplitude), because every kind of colour vision distinguishes them.

/// Red, green and blue in sRGB, 0 to 255 each.
pub type Rgb = [u8; 3];

/// OKLab (lightness 0..1, a, b) as sRGB; a colour outside sRGB is clipped.
fn oklab(lightness: f32, a: f32, b: f32) -> Rgb {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    let linear = [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ];
    linear.map(|channel: f32| {
        let channel = channel.clamp(0.0, 1.0);
        let encoded =
            if channel <= 0.003_130_8 { 12.92 * channel } else { 1.055 * channel.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

/// Signed displacement, -1..=1: blue below zero, the plate's own colour at zero, orange above.
#[must_use]
pub fn diverging(value: f32, dark: bool) -> Rgb {
    let value = if value.is_finite() { value.clamp(-1.0, 1.0) } else { 0.0 };
    let strength = value.abs();
    // Both arms have the same lightness and chroma, so that positive and negative values look equally strong.
    let lightness = if dark { 0.27 + 0.53 * strength } else { 0.95 - 0.47 * strength };
    let chroma = 0.15 * strength.powf(0.7);
    let hue = if value < 0.0 { 255f32 } else { 55f32 }.to_radians();
    oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
}

/// Amplitude, 0..=1: lightness rises (dark theme) or falls (light theme) in equal steps.
#[must_use]
pub fn sequential(value: f32, dark: bool) -> Rgb {
    let value = if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
    let lightness = if dark { 0.24 + 0.66 * value } else { 0.96 - 0.62 * value };
    // From yellow at the light end to blue at the dark end, through teal.
    let darkness = if dark { 1.0 - value } else { value };
    let hue = (100.0 + 160.0 * darkness).to_radians();
    let chroma = if dark { 0.03 + 0.11 * value } else { 0.015 + 0.11 * value };
    oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG relative luminance.
    fn luminance(colour: Rgb) -> f32 {
        let [red, green, blue] = colour.map(|channel| {
            let value = f32::from(channel) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    #[test]
    fn equal_steps_of_amplitude_are_equal_steps_of_lightness() {
        for dark in [false, true] {
            let steps: Vec<f32> =
                (0..=16).map(|i| luminance(sequential(i as f32 / 16.0, dark)).cbrt()).collect();
            let mean = (steps[16] - steps[0]) / 16.0;
            for pair in steps.windows(2) {
                assert!(((pair[1] - pair[0]) / mean - 1.0).abs() < 0.6, "{dark} {pair:?} {mean}");
            }
        }
    }

    #[test]
    fn positive_and_negative_have_similar_luminance_and_zero_is_the_plates_colour() {
        for dark in [false, true] {
            assert_eq!(diverging(0.0, dark), diverging(f32::NAN, dark));
            for value in [0.25, 0.5, 1.0] {
                let (up, down) = (diverging(value, dark), diverging(-value, dark));
                let ratio = luminance(up) / luminance(down);
                assert!((0.7..1.4).contains(&ratio), "{value} {ratio}");
                assert!(up[0] > down[0] && up[2] < down[2]);
            }
        }
    }
}
