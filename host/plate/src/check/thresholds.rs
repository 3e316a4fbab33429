//! Where each light turns from green to amber and from amber to red, with the reason.

/// A pair of limits: up to `green` the light is green, up to `amber` it is amber, beyond it is red.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Last value that is green.
    pub green: f64,
    /// Last value that is amber.
    pub amber: f64,
}

/// |W'|. A plate this steep adds (1/4 + pi^2/12) (W'/W)^2 to the (pi/2W)^2 of the width term, which is 0.435 W'^2 of
/// it: 2.7 % at 0.25 (the boundary moves by 1.4 % of 1/d, a few millimetres), 11 % at 0.5 (5 % of 1/d, a finger).
pub const EDGE_SLOPE: Limits = Limits { green: 0.25, amber: 0.5 };

/// W |W''|. It stands beside W'^2 in every term the amplitude equation leaves out, so it has the squares of
/// [`EDGE_SLOPE`]'s limits.
pub const EDGE_CURVATURE: Limits = Limits { green: 0.0625, amber: 0.25 };

/// Wavelengths from the driven end to the boundary, counted downward. The Airy peak has phase 0.686 rad (0.109
/// wavelengths) in front of the turning point and the first node 2.383 rad (0.379): with less than the first there is
/// no room for the peak, with less than the second the vibrating side has not even one whole antinode.
pub const WAVELENGTHS: Limits = Limits { green: 0.379, amber: 0.109 };

/// Loss integral I: the wave dies as e^-I on its way to the boundary. About 3 the peak is no longer the largest
/// amplitude on the plate, about 6 it is gone.
pub const LOSS: Limits = Limits { green: 3.0, amber: 6.0 };

/// Width of a fingertip's contact, metres: the size an edge is measured by.
pub const FINGERTIP_M: f64 = 0.01;

/// Edge width in fingertips. Up to 4 one short stroke crosses the edge; beyond 15 (150 mm) it is wider than a hand and
/// feels like a slow fade, not like a boundary.
pub const EDGE_WIDTH: Limits = Limits { green: 4.0, amber: 15.0 };

/// Change of the peak per 1 % of wave speed, dB. Vibration has to change by about 1 dB to be noticed; 6 dB is a factor
/// of two, and temperature or tension alone move the wave speed by a per cent.
pub const SENSITIVITY_DB: Limits = Limits { green: 1.0, amber: 6.0 };

/// r or 1/r of the drive end, whichever is larger. 1.41 reflects 17 % of the returning wave; 2 reflects a third and
/// costs 5 dB of peak per 1 % of wave speed on a plate of low loss, 5 costs 11 dB.
pub const DRIVE_MISMATCH: Limits = Limits { green: 1.415, amber: 2.0 };

/// Loss of the actuator against its own response at rest, dB. 6 dB is half the travel; behind 20 dB the table has a
/// tenth of the travel left to work with.
pub const ACTUATOR_LOSS_DB: Limits = Limits { green: 6.0, amber: 20.0 };

/// Difference of the thin plate's wavenumber from the thick plate's (Mindlin), %. 1 % moves a boundary by 1 % of 1/d,
/// about 2 mm at d = 5 per metre; 5 % by a whole fingertip.
pub const THIN_PLATE_PERCENT: Limits = Limits { green: 1.0, amber: 5.0 };

/// From this frequency on a tone is not heard and can make a surface slippery, Hz.
pub const ULTRASONIC_HZ: f64 = 20e3;

/// Two ultrasonic tones nearer than this beat at a rate that skin feels (it feels up to about 1 kHz), Hz.
pub const BEAT_HZ: f64 = 1e3;

/// Audible sound at [`LISTENER_M`], dB(A). 85 dB(A) is where a working day needs ear protection; 70 dB(A) is a loud
/// voice.
pub const AUDIBLE_DB_A: Limits = Limits { green: 70.0, amber: 85.0 };

/// Sound in the third-octave band of 20 kHz at [`LISTENER_M`], dB: the guideline values for the public and at work.
pub const NEAR_ULTRASOUND_DB: Limits = Limits { green: 70.0, amber: 75.0 };

/// Ultrasound above that band at [`LISTENER_M`], dB: the guideline values for the public and at work.
pub const ULTRASOUND_DB: Limits = Limits { green: 100.0, amber: 110.0 };

/// Upper end of the third-octave band of 20 kHz, Hz.
pub const NEAR_ULTRASOUND_END_HZ: f64 = 22_400.0;

/// Distance of the listener whose sound level is bounded, metres.
pub const LISTENER_M: f64 = 0.5;
