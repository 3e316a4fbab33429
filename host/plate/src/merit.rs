//! Figures of merit of a boundary: its sharpness, its switching time, and the number of boundaries that can be
//! distinguished.
//!
//! ```text
//! solid area of 16 tones (texture) -> contrast, ripple, edge width
//! the boundary's own tone, switched on, on the plate in time -> switching time
//! a second peak that approaches the first -> two-point distance
//! span over two-point distance, switching time -> bits per second
//! ```

mod switching;

use crate::feeling::{Feeling, FeltTone};
use crate::intermodulation::products;
use crate::second_boundary::DrivenTone;
use crate::texture::{Figures, PLACES, Palette, TONES_MAX, Target, Texture, TextureError};
use switching::{Peak, last_top};

/// Number of turning points between the start of the span and the boundary at which a second peak is tried.
const NEIGHBOURS: usize = 400;
/// Two peaks can be distinguished if the mean square between them falls to this fraction of that of the peaks: 3 dB.
const DIP: f64 = 0.5;

/// Figures of merit of one boundary.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Merit {
    /// Turning point of the boundary, metres.
    pub turning_point_m: f64,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Ratio of the mean square in the solid area to that 1.4 edge widths past the turning point, dB.
    pub contrast_db: f64,
    /// The same ratio of the square of what a usual finger feels, with the harmonics of the drive, dB; `None` if the plate file states
    /// no harmonics.
    // JSON: The same ratio in sensation, with the drive's harmonics; null where the plate file states none
    pub felt_contrast_db: Option<f64>,
    /// Ratio of the largest to the smallest RMS amplitude in the solid area, dB.
    pub ripple_db: f64,
    /// Distance over which the amplitude falls from 90 % to 10 % of the solid area's RMS amplitude, metres.
    pub edge_width_m: f64,
    /// Time from the code that switches the boundary's tone on until its peak stays within 10 % of its amplitude,
    /// seconds, by the plate in time; `None` if the plate has no time-domain line.
    // JSON: Time in which the boundary moves
    pub switching_time_s: Option<f64>,
    /// Least distance of a second, equally high peak before this one such that the mean square between them falls by
    /// 3 dB, metres; `None` if no tone of the span gives one.
    // JSON: Least distance of two boundaries that are felt apart; null where unknown
    pub two_point_m: Option<f64>,
    /// log2(1 + span / two-point distance) / switching time: the information in a choice among distinguishable
    /// boundaries, at the rate at which they can be switched, bit/s. `None` without one of the two figures.
    // JSON, bit/s: Rate at which a finger can tell places apart by the edge; null where unknown
    pub bits_per_s: Option<f64>,
}

impl Merit {
    /// The figures of the boundary at `turning_point_m`, which must lie in the table's span.
    ///
    /// # Errors
    /// As [`Target::solid`] and [`Texture::fit`]; [`TextureError::Silent`] if the area has no contrast or ripple.
    pub fn of(palette: &Palette<'_>, turning_point_m: f64) -> Result<Self, TextureError> {
        let (plate, table) = (palette.plate(), palette.table());
        let target = Target::solid(palette, turning_point_m)?;
        let texture = Texture::fit(palette, &target, TONES_MAX)?;
        let figures = texture.figures;
        let (Some(contrast_db), Some(ripple_db)) = (figures.contrast_db, figures.ripple_db) else {
            return Err(TextureError::Silent);
        };
        let frequency_hz = table.frequency_hz(turning_point_m);
        let switching_time_s = Peak::of(palette, turning_point_m)?.switching_time_s(palette);
        let two_point_m = two_point_m(palette, turning_point_m)?;
        let (start_m, end_m) = plate.span_m();
        let bits = |distance_m: f64| (1.0 + (end_m - start_m) / distance_m).log2();
        Ok(Self {
            turning_point_m,
            frequency_hz,
            contrast_db,
            felt_contrast_db: felt_contrast_db(palette, &texture, &target)?,
            ripple_db,
            edge_width_m: edge_width_m(&texture, &target),
            switching_time_s,
            two_point_m,
            bits_per_s: two_point_m
                .zip(switching_time_s)
                .map(|(distance_m, time_s)| bits(distance_m) / time_s),
        })
    }
}

/// The contrast of a texture in the strength of the sensation of a usual finger, with the products of the drive.
fn felt_contrast_db(
    palette: &Palette<'_>,
    texture: &Texture,
    target: &Target,
) -> Result<Option<f64>, TextureError> {
    let (plate, table) = (palette.plate(), palette.table());
    if plate.spec().harmonics.is_none() {
        return Ok(None);
    }
    let positions_m: Vec<f64> = texture.tones.iter().map(|tone| tone.position_m).collect();
    let peak_m = table.peak_at_full_scale_m();
    let columns = palette.squares(&positions_m)?;
    let of_tones = texture.tones.iter().zip(columns.iter()).map(|(tone, squares)| {
        let power = (tone.level * peak_m).powi(2);
        (tone.frequency_hz, squares.iter().map(|square| square * power).collect())
    });
    let mut felt: Vec<(f64, Vec<f64>)> = of_tones.collect();
    let driven = texture.tones.iter().map(|tone| DrivenTone {
        frequency_hz: tone.frequency_hz,
        level: tone.level,
        drive_m: table.driven_end_m(plate, tone.position_m) * tone.level,
    });
    let driven: Vec<DrivenTone> = driven.collect();
    felt.extend(products(plate, &driven, PLACES).map_err(|_| TextureError::Silent)?);
    let tones: Vec<FeltTone<'_>> =
        felt.iter().map(|(hz, squares)| FeltTone { frequency_hz: *hz, squares }).collect();
    let strength = Feeling::default().strength(plate, &tones);
    let squares: Vec<f64> = strength.iter().map(|strength| strength * strength).collect();
    Ok(Figures::of(&squares, &texture.places_m, target).contrast_db)
}

/// Distance from the last place with 90 % to the last with 10 % of the area's RMS amplitude, metres.
fn edge_width_m(texture: &Texture, target: &Target) -> f64 {
    let counted = texture.rms_m.iter().zip(target.wanted()).zip(target.weight());
    let area: Vec<f64> = counted
        .filter(|((_, wanted), weight)| **wanted > 0.0 && **weight > 0.0)
        .map(|((rms, _), _)| *rms)
        .collect();
    let mean = area.iter().sum::<f64>() / area.len() as f64;
    let step_m = texture.places_m[1];
    let last_above = |share: f64| {
        let last = texture.rms_m.iter().rposition(|&rms| rms >= share * mean).unwrap_or(0);
        let next = (last + 1).min(texture.rms_m.len() - 1);
        let (here, there) = (texture.rms_m[last], texture.rms_m[next]);
        let part = if there < here { (here - share * mean) / (here - there) } else { 0.0 };
        (last as f64 + part.min(1.0)) * step_m
    };
    last_above(0.1) - last_above(0.9)
}

/// The least distance of a second peak, metres; see [`Merit::two_point_m`].
fn two_point_m(palette: &Palette<'_>, turning_point_m: f64) -> Result<Option<f64>, TextureError> {
    let start_m = palette.table().span_m().0;
    let step_m = (turning_point_m - start_m) / NEIGHBOURS as f64;
    if step_m <= 0.0 {
        return Ok(None);
    }
    let positions_m: Vec<f64> = (0..=NEIGHBOURS).rev().map(|i| start_m + step_m * i as f64).collect();
    let columns = palette.squares(&positions_m)?;
    let places_m = palette.places_m();
    let tops: Vec<usize> = columns.iter().map(last_top).collect();
    let (far, far_top) = (columns.column(0), tops[0]);
    for (near, &near_top) in columns.iter().zip(&tops).skip(1) {
        // The power of the nearer tone for which both peaks are equally high.
        let power = (far[far_top] - far[near_top]) / (near[near_top] - near[far_top]);
        if near_top >= far_top || power.is_nan() || power < 0.0 {
            continue;
        }
        let sum = |place: usize| power * near[place] + far[place];
        let valley = (near_top..far_top).map(sum).fold(f64::INFINITY, f64::min);
        if valley <= DIP * sum(far_top) {
            return Ok(Some(places_m[far_top] - places_m[near_top]));
        }
    }
    Ok(None)
}
