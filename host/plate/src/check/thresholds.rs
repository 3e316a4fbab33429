//! The limits of each light between green, amber and red, with the reason for each.

use serde::Serialize;

/// A pair of limits: up to `green` the light is green, up to `amber` it is amber, beyond it is red.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, serde::Deserialize)]
pub struct Limits {
    /// Last value that is green.
    // JSON, unit of the light: Last value that is green
    pub green: f64,
    /// Last value that is amber.
    // JSON, unit of the light: Last value that is amber
    pub amber: f64,
}

/// |W'| at the boundary, where the turning width is measured along the arc. What the arc leaves of the error of the plain
/// width, W'^2/3, is at most a third of that: 1.8 % of the width at 0.4 and 7.1 % at 0.8. The place is off by that part of
/// 1/d, 4 and 14 mm at d = 5 per metre.
pub const EDGE_SLOPE: Limits = Limits { green: 0.4, amber: 0.8 };

/// |W'| at the boundary, where the turning width is measured straight across. Between edges at an angle the wave's fronts
/// are arcs, and it turns where half of the arc, W atan(W')/W', equals the W of parallel edges: so the law of the plain
/// width is off by W'^2/3 of the width, which is 2.1 % at 0.25 and 8.3 % at 0.5.
///
/// The limits of clamped edges are these, too: there the taper mixes the width modes so much that of 1200 random plates one
/// with |W'| = 0.39 was 2.8 dB off.
pub const EDGE_SLOPE_STRICT: Limits = Limits { green: 0.25, amber: 0.5 };

/// W |W''|. In every term that the amplitude equation neglects it appears beside W'^2, so its limits are the squares of
/// the limits of [`EDGE_SLOPE_STRICT`]: the arc knows nothing of it.
pub const EDGE_CURVATURE: Limits = Limits { green: 0.0625, amber: 0.25 };

/// Wavelengths from the driven end to the boundary; green from `green` up, amber from `amber` up. In the Airy form the
/// peak lies 0.686 rad (0.109 wavelengths) of phase before the turning point and the first node 2.383 rad (0.379).
/// With less than 0.109 there is no room for the peak; with less than 0.379 there is no room for one whole antinode.
pub const WAVELENGTHS: Limits = Limits { green: 0.379, amber: 0.109 };

/// Wavelengths from the driven end to the boundary below which a peak is not sure: the drive's own motion hides it. On
/// 2000 random plates the two-dimensional solver has found none where the one-mode equation has one up to 0.263 of them.
pub(crate) const PEAK_ROOM: f64 = 0.28;

/// Loss integral I: the amplitude falls by e^-I on the way to the boundary. From about 3 on the peak is no longer the
/// largest amplitude on the plate; at about 6 there is no peak.
pub(crate) const LOSS: Limits = Limits { green: 3.0, amber: 6.0 };

/// Loss integral up to which the loss light does not ask for the peak: the wave arrives with more than a third of its
/// amplitude, and the narrowing plate raises it by about as much. Beyond it the light takes the computed peak's colour.
pub const LOSS_SMALL: f64 = 1.0;

/// Width of a fingertip's contact, metres: the unit of the edge width.
pub(crate) const FINGERTIP_M: f64 = crate::frequency::CONTACT_M;

/// Edge width in fingertips. Up to 4, one short stroke of the finger crosses the edge. Beyond 15 (150 mm) the edge is
/// wider than a hand and feels like a slow fade, not like a boundary.
pub const EDGE_WIDTH: Limits = Limits { green: 4.0, amber: 15.0 };

/// Change of the peak, dB, where the wave speed is off by 1 % or the loss by its tolerance. Vibration has to change by
/// about 1 dB to be noticed (the least median that PHYSICS.md, section 5, has a source for is 1.6 dB); 6.02 dB is a factor of two, and temperature or tension alone move the wave speed by a per cent.
pub const SENSITIVITY_DB: Limits = Limits { green: 1.0, amber: 6.02 };

/// Relative uncertainty of the loss factor where the plate file does not state it: halved or doubled. Loss factors in
/// tables and from one sheet to the next differ by as much, and mounting adds to them.
pub(crate) const LOSS_TOLERANCE: f64 = 1.0;

/// |r| of the drive end, the share of the returning wave's amplitude that it sends back. A resistance that is wrong by a
/// factor of 1.41 sends 17 % back, one that is wrong by 2 a third. On a plate of low loss 1 % of wave speed changes the
/// peak by up to 20 lg((1 + |r|)/(1 - |r|)): 3 dB at 17 %, 6 dB at a third (5 dB were found there), 13 dB at 0.64.
pub const DRIVE_REFLECTION: Limits = Limits { green: 0.172, amber: 0.334 };

/// Attenuation of the actuator relative to its response at 0 Hz, dB. 6 dB halves the travel; at 20 dB a tenth of the
/// travel is left.
pub const ACTUATOR_LOSS_DB: Limits = Limits { green: 6.0, amber: 20.0 };

/// How far the actuator would move if the peak travel did not lower the table, % of the peak travel. Beyond 100 % the
/// table is lowered; beyond 1000 % it has lost more than 20 dB, and less than a tenth of the level is left.
pub const EXCURSION_PERCENT: Limits = Limits { green: 100.0, amber: 1000.0 };

/// How much larger the thick plate's wavenumber (Mindlin) is than the thin plate's, %. 1 % moves a boundary by 1 % of
/// 1/d, about 2 mm at d = 5 per metre; 5 % moves it by a fingertip.
pub const THIN_PLATE_PERCENT: Limits = Limits { green: 1.0, amber: 5.0 };

/// How far the peak may be from where the file puts it by the air, mm: up to this green, else amber. 2 mm is 1 % of wave speed
/// at d = 5 per metre.
pub(crate) const AIR_MM: f64 = 2.0;

/// How much larger a film's wavenumber is than that of the membrane that turns where it does, just before the boundary, %: 0.5 %
/// at W = 8.6 sqrt(D/T), 2 % at 5.5 times. Farther from the boundary it is a fraction of that, and at the boundary nothing.
pub const FILM_PERCENT: Limits = Limits { green: 0.5, amber: crate::definition::limits::FILM_PERCENT };

/// Thickness over width, h/2W, at the boundary. What a plate theory leaves out of the stresses at an edge decays within
/// about h/pi of it. At 0.2, textbooks' limit of a moderately thick plate, both edges' layers take 13 % of the width; at 0.5
/// they take a third, and half a wave across the plate is only two thicknesses long.
pub const THICKNESS_SHARE: Limits = Limits { green: 0.2, amber: 0.5 };

/// Width of the plate at the boundary in fingertips; green from `green` up, amber from `amber` up. A plate narrower than
/// the contact carries part of the fingertip on its edges, below half of it most of the fingertip.
pub const WIDTH: Limits = Limits { green: 1.0, amber: 0.5 };

/// |Z_f|/Z, the impedance of a light touch over the wave's. On the presets a peak falls by about 20 lg(1 + 2.6 |Z_f|/Z): by
/// 2 dB at 0.1, and by 11 dB at 1, which leaves less than a third.
pub const FINGER_LOAD: Limits = Limits { green: 0.1, amber: 1.0 };

/// What a light touch takes from the peak under it, dB. At equal load a resonance loses several times as much as a wave
/// that passes once. Up to 1.5 dB is hardly noticed; 20 dB leave a tenth.
pub(crate) const FINGER_DB: Limits = Limits { green: 1.5, amber: 20.0 };

/// A harmonic of the drive beyond the felt edge of its tone, dB over the threshold of a usual finger. From 6 dB on it is clearly
/// felt (no source: a round value, as that of a felt strip).
pub const HARMONIC_DB: Limits = Limits { green: 0.0, amber: 6.0 };

/// Steps of the device's 12-bit DAC from the middle to full scale.
pub(crate) const DAC_AMPLITUDE_STEPS: f64 = 2047.5;

/// DAC steps of a tone's amplitude at level 1; green from `green` up, amber from `amber` up. One step changes an amplitude
/// of 16 steps by 0.5 dB, half of what vibration has to change to be noticed, and one of 4 steps by 2 dB.
pub const DAC_STEPS: Limits = Limits { green: 16.0, amber: 4.0 };

/// From this frequency on, Hz, a tone is inaudible and can make a surface slippery.
pub(crate) const ULTRASONIC_HZ: f64 = crate::check::sensation::SLIPPERY_FROM_HZ;

/// Two ultrasonic tones closer than this, Hz, beat at a rate that skin can feel (up to about 1 kHz).
pub const BEAT_HZ: f64 = 1e3;

/// Audible sound at [`LISTENER_M`], dB(A). 70 dB(A) is a loud voice; from 85 dB(A) on, a working day requires ear
/// protection.
pub const AUDIBLE_DB_A: Limits = Limits { green: 70.0, amber: 85.0 };

/// Sound in the third-octave band of 20 kHz at [`LISTENER_M`], dB: the guideline values for the public (green) and for
/// workers (amber).
pub(crate) const NEAR_ULTRASOUND_DB: Limits = Limits { green: 70.0, amber: 75.0 };

/// Ultrasound above that band at [`LISTENER_M`], dB: the guideline values for the public (green) and for workers
/// (amber).
pub(crate) const ULTRASOUND_DB: Limits = Limits { green: 100.0, amber: 110.0 };

/// Upper end of the third-octave band of 20 kHz, Hz.
pub(crate) const NEAR_ULTRASOUND_END_HZ: f64 = 22_400.0;

/// Motion of the frame beyond the boundary over what a usual finger just feels, dB: half of the spread of persons below it nobody
/// feels it, and 6 dB over it everybody does.
pub const FRAME_DB: Limits = Limits { green: -0.5 * crate::feeling::PERSONS_DB, amber: 6.0 };

/// The mass of a table is stated in multiples of this, kg: the frame's motion is known to a factor of two.
pub(crate) const FRAME_TABLE_STEP_KG: f64 = 1.0;

/// Shift of the boundary by one kelvin, mm: ten kelvin between winter and summer, or beside a lamp, are half of a fingertip at 0.5
/// and five fingertips at 5.
pub const DRIFT_MM_PER_K: Limits = Limits { green: 0.5, amber: 5.0 };

/// How far a finger sinks in that presses with 0.5 N, mm: up to this green, else amber. At 100 N/m it is 1 mm, and stretches
/// latex by less than a thousandth.
pub(crate) const PRESS_MM: f64 = 1.0;

/// Distance of the listener whose sound level is bounded, metres.
pub const LISTENER_M: f64 = 0.5;
