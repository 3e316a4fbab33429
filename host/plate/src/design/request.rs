//! The request to the designer: sheet, wave, band and length.

use super::material::Material;
use crate::definition::air::Air;
use crate::definition::film::Film;
use crate::definition::limits;
use crate::definition::model::{Bending, Model};
use crate::quantity::Range;
use crate::quantity::number_format::rounded;
use serde::Serialize;

/// How the sheet carries the wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wave {
    /// A stiff plate in bending.
    Bending {
        /// How its edges are held.
        edge: Edge,
        /// Whether shear and rotary inertia are included (Mindlin).
        thick_plate: bool,
    },
    /// A stretched membrane between fixed edges.
    Membrane {
        /// Wave speed sqrt(tension stress/density), m/s (0.1 to 20 000).
        wave_speed_m_per_s: f64,
    },
    /// The shear-horizontal wave of the material between fixed edges.
    ShearHorizontal,
}

impl Wave {
    /// Whether the wave moves the air beside it: all but the shear wave, which moves in its own plane.
    #[must_use]
    pub const fn carries_air(self) -> bool {
        match self {
            Self::Bending { .. } | Self::Membrane { .. } => true,
            Self::ShearHorizontal => false,
        }
    }

    /// A membrane of this material and thickness (m) under `tension_n_per_m`: speed = sqrt(tension/(density
    /// thickness)).
    #[must_use]
    pub fn under_tension(tension_n_per_m: f64, material: &Material, thickness_m: f64) -> Self {
        let surface_density = material.density_kg_per_m3 * thickness_m;
        Self::Membrane { wave_speed_m_per_s: (tension_n_per_m / surface_density).sqrt() }
    }

    /// The tensions of a sheet, N per metre of width: those of the slowest and the fastest wave, T = c^2 rho h.
    #[must_use]
    pub fn tensions(material: &Material, thickness_m: f64) -> Range {
        let surface_density = material.density_kg_per_m3 * thickness_m;
        let tension_of = |speed: f64| speed * speed * surface_density;
        Range::new(tension_of(limits::WAVE_SPEED.low), tension_of(limits::WAVE_SPEED.high), "N/m")
    }
}

/// How the long edges of a bending plate are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Edge {
    /// On a knife edge: no displacement, free to rotate.
    Supported,
    /// Between the halves of a stiff frame: no displacement, no rotation.
    Clamped,
}

/// The data from which a plate is designed.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Short name of the plate, 1 to 80 characters.
    pub name: String,
    /// Material of the sheet.
    pub material: Material,
    /// Thickness of the sheet, metres (1e-6 to 0.1).
    pub thickness_m: f64,
    /// How the sheet carries the wave.
    pub wave: Wave,
    /// Frequencies of the nearest and the farthest boundary, Hz (0.5 to 1e7; the second at least 5 % above the first).
    pub band_hz: (f64, f64),
    /// Length from the driven end to the narrow end, metres (0.005 to 10).
    pub length_m: f64,
    /// From the driven end to the nearest boundary, metres (see [`super::start_margin_range`]); `None` for the length
    /// that its peak needs.
    pub start_margin_m: Option<f64>,
    /// From the farthest boundary to the narrow end, metres (see [`super::end_margin_range`]); `None` for the length
    /// that its tail needs.
    pub end_margin_m: Option<f64>,
    /// Displacement of the drive at DAC full scale, metres (1e-9 to 0.1).
    pub full_scale_m: f64,
    /// Width of the frame's rim, metres (0.01 to 0.5: the bolts need room).
    pub rim_m: f64,
    /// The air around the plate; `None` for a plate designed without air. A shear wave moves no air.
    pub air: Option<Air>,
}

impl Request {
    /// A request with defaults for the other fields: margins as needed; a rim of 20 mm; a full-scale displacement of
    /// 1 um if the band starts at 1 kHz or above, else 100 um; and, for a wave that moves the air, the air of a room on
    /// both faces and around the edges.
    pub fn new(
        name: &str,
        material: Material,
        thickness_m: f64,
        wave: Wave,
        band_hz: (f64, f64),
        length_m: f64,
    ) -> Self {
        Self {
            name: name.to_owned(),
            material,
            thickness_m,
            wave,
            band_hz,
            length_m,
            start_margin_m: None,
            end_margin_m: None,
            full_scale_m: if band_hz.0 >= 1e3 { 1e-6 } else { 1e-4 },
            rim_m: 0.02,
            air: wave.carries_air().then_some(Air::ROOM),
        }
    }

    /// The plate's wave model.
    pub(super) fn model(&self) -> Model {
        let material = &self.material;
        match self.wave {
            Wave::Membrane { wave_speed_m_per_s } => {
                let surface_density = material.density_kg_per_m3 * self.thickness_m;
                let tension_n_per_m = Some(surface_density * wave_speed_m_per_s.powi(2));
                let film = Film {
                    youngs_modulus_pa: material.youngs_modulus_pa,
                    poisson_ratio: material.poisson_ratio,
                    thickness_m: self.thickness_m,
                };
                Model::Membrane { wave_speed_m_per_s, tension_n_per_m, film: Some(film) }
            }
            Wave::ShearHorizontal => Model::ShearHorizontal {
                shear_modulus_pa: material.shear_modulus_pa(),
                density_kg_per_m3: material.density_kg_per_m3,
                thickness_m: Some(self.thickness_m),
            },
            Wave::Bending { edge, thick_plate } => {
                let bending = Bending {
                    youngs_modulus_pa: material.youngs_modulus_pa,
                    poisson_ratio: material.poisson_ratio,
                    density_kg_per_m3: material.density_kg_per_m3,
                    thickness_m: self.thickness_m,
                    thick_plate,
                };
                match edge {
                    Edge::Supported => Model::BendingSupported(bending),
                    Edge::Clamped => Model::BendingClamped(bending),
                }
            }
        }
    }

    /// A one-line description of the plate.
    pub(super) fn describe(&self) -> String {
        let wave = match self.wave {
            Wave::Membrane { .. } => "stretched",
            Wave::ShearHorizontal => "SH wave",
            Wave::Bending { edge: Edge::Supported, .. } => "bending, supported edges",
            Wave::Bending { edge: Edge::Clamped, .. } => "bending, clamped edges",
        };
        let hertz = |hertz: f64| match hertz {
            1e3.. => format!("{} kHz", rounded(hertz * 1e-3, 3)),
            _ => format!("{} Hz", rounded(hertz, 3)),
        };
        format!(
            "Designed: {} {} mm, {wave}, turning points from {} to {}",
            self.material.name,
            rounded(self.thickness_m * 1e3, 4),
            hertz(self.band_hz.0),
            hertz(self.band_hz.1)
        )
    }
}
