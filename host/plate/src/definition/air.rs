//! The air around a plate: what it is, how the plate stands in it, and the inertia that it adds to a wave.
//!
//! A wave of the in-plane number K moves the air beside a face as far as about 1/K from it. Where it is slower than sound the
//! air follows as a mass per area, and both faces carry
//!
//! ```text
//! mu(K) = faces alpha g rho/K,    g = 1/(1 + (V(K)/(0.65 c_s))^3)
//! ```
//! with the density rho, the speed of sound c_s and the wave's speed V in vacuum. Along a membrane alpha changes
//! (`air_along.rs`), and a baffle holds the pressure together at a distance (`frequency/far_air.rs`); these are the numbers at the
//! turning point. alpha is 1 for an endless plane wave. A
//! plate of finite width moves a net volume and carries more in a baffle ([`BAFFLE`]); without one the air goes round its
//! edges ([`BARE_FRAME`]). g falls to 0 where the wave is faster than sound: it radiates there and carries no mass. It is
//! that of the half-wave strip in a baffle at its cut-off, within 0.08.
//!
//! A table, a rigid wall, at the distance g_t below the lower face holds the air between: it follows cosh K(y + g_t), so that
//! this face carries coth(K g_t) times as much. The half-wave strip in the open above a wall (a potential of a flat strip and its
//! image) carries within 6 % of that on both faces together while g_t is a fifth of its half-width or more, 13 % less at a tenth.

use crate::definition::error::PlateError;
use crate::definition::model::Model;

/// alpha of each face in a rigid baffle, at the turning point: what the peaks of membranes in two dimensions with the air's own
/// matrix ask for.
pub(crate) const BAFFLE: f64 = 2.1;
/// alpha of each face of a plate whose air goes round its edges, at the turning point. The half-wave strip without a baffle has
/// 1.342; membranes in two dimensions ask for 1.25 to 1.33.
pub(crate) const BARE_FRAME: f64 = 1.29;
/// alpha of each face of a plate whose mounting nobody knows: the geometric mean of the two, whose ratio is 1.63.
const UNKNOWN_MOUNTING: f64 = 1.65;
/// Standard deviation of ln alpha where the mounting or the coefficient is stated: membranes in two dimensions ask for up to 8 %
/// more or less, and a film's mass per area is known to a few per cent.
const STATED: f64 = 0.1;
/// The same of an unknown mounting: about half of ln(2.1/1.29), so that either end is one standard deviation away.
const UNKNOWN: f64 = 0.22;
/// Wave speed in vacuum over that of sound at which half of the mass is left.
const HALF_MASS: f64 = 0.65;

/// Pressure of the standard atmosphere at sea level, Pa.
const PRESSURE_PA: f64 = 101_325.0;
/// Temperature of the standard atmosphere at sea level, K, and how it falls with height, K/m.
const STANDARD_K: (f64, f64) = (288.15, 0.0065);
/// g/(R times the fall of the temperature): the exponent of the pressure.
const EXPONENT: f64 = 5.255_88;
/// R of dry air, J/(kg K), and its ratio of specific heats.
const GAS: (f64, f64) = (287.052_87, 1.4);
/// 0 degrees Celsius, K.
const ZERO_K: f64 = 273.15;

/// The air around a plate, `[air]` of a plate file.
///
/// ```
/// use slipline_plate::{Air, AirMounting, Gas};
///
/// let room = Gas::Atmosphere { temperature_c: 20.0, height_m: 0.0 };
/// assert!((room.density_kg_per_m3() - 1.204).abs() < 1e-3);
/// assert!((room.sound_speed_m_per_s() - 343.2).abs() < 0.1);
/// let air = Air::Around { gas: room, mounting: AirMounting::BareFrame, gap_m: None };
/// assert!(air.mounting().is_some() && Air::Vacuum.mounting().is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Air {
    /// None. The plate's numbers are those of a file without `[air]`.
    Vacuum,
    /// Air that swings with the plate.
    Around {
        /// What it is.
        gas: Gas,
        /// How the plate stands in it.
        mounting: AirMounting,
        /// Distance of a table from the lower face, metres (0.003 to 1), open at its sides; `None` where nothing is near. Not in
        /// a baffle, which would close the gap.
        gap_m: Option<f64>,
    },
}

/// Density and speed of sound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gas {
    /// As numbers.
    Given {
        /// Density rho, kg/m^3 (0.05 to 20).
        density_kg_per_m3: f64,
        /// Speed of sound c_s, m/s (100 to 2000).
        sound_speed_m_per_s: f64,
    },
    /// Dry air of this temperature under the pressure of the standard atmosphere (ISO 2533) at this height.
    Atmosphere {
        /// Temperature, degrees Celsius (-60 to 100).
        temperature_c: f64,
        /// Height above the sea, metres (-500 to 9000).
        height_m: f64,
    },
}

/// How a plate stands in the air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AirMounting {
    /// In a wide rigid wall, so that no air goes from one face to the other.
    Baffle {
        /// The faces that have air.
        faces: Faces,
    },
    /// In a narrow frame, air on both faces and round the edges.
    BareFrame,
    /// Nobody knows: between a bare frame and a baffle, air on both faces. A calibration finds the coefficient.
    Unknown,
    /// As the coefficient says.
    Coefficient {
        /// alpha of each face (0 to 10).
        alpha: f64,
        /// The faces that have air.
        faces: Faces,
    },
    /// As a calibration found it.
    Calibrated {
        /// alpha of each face (0 to 10).
        alpha: f64,
        /// The faces that have air.
        faces: Faces,
        /// The share of the pressure at a distance that a baffle holds together (-1 to 2): about 1 in a baffle, 0 without one.
        distant: f64,
    },
}

/// The faces of a plate that have air.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Faces {
    /// One of them; the other has a vacuum or a light foam that holds no air.
    One,
    /// Both.
    #[default]
    Two,
}

impl AirMounting {
    /// alpha of each face that has air, and these faces.
    #[must_use]
    pub const fn coefficient(self) -> (f64, Faces) {
        match self {
            Self::Baffle { faces } => (BAFFLE, faces),
            Self::BareFrame => (BARE_FRAME, Faces::Two),
            Self::Unknown => (UNKNOWN_MOUNTING, Faces::Two),
            Self::Coefficient { alpha, faces } | Self::Calibrated { alpha, faces, .. } => (alpha, faces),
        }
    }

    /// The same with the coefficient and the share of the pressure at a distance that were found; one that is stated as a
    /// coefficient has no such share.
    pub(crate) const fn found(self, alpha: f64, distant: f64) -> Self {
        let (_, faces) = self.coefficient();
        match self {
            Self::Coefficient { .. } => Self::Coefficient { alpha, faces },
            Self::Baffle { .. } | Self::BareFrame | Self::Unknown | Self::Calibrated { .. } => {
                Self::Calibrated { alpha, faces, distant }
            }
        }
    }

    /// How well that coefficient is known before a calibration: the standard deviation of its logarithm.
    pub(crate) const fn deviation(self) -> f64 {
        match self {
            Self::Baffle { .. } | Self::BareFrame | Self::Coefficient { .. } | Self::Calibrated { .. } => {
                STATED
            }
            Self::Unknown => UNKNOWN,
        }
    }

    /// The same with the other number of faces in air; `None` where it is no field of the file.
    pub(crate) const fn on_other_faces(self) -> Option<Self> {
        match self {
            Self::Baffle { faces } => Some(Self::Baffle { faces: faces.other() }),
            Self::Coefficient { alpha, faces } => Some(Self::Coefficient { alpha, faces: faces.other() }),
            Self::Calibrated { .. } | Self::BareFrame | Self::Unknown => None,
        }
    }

    /// An unknown mounting where this one is stated in words.
    pub(crate) const fn as_unknown(self) -> Option<Self> {
        match self {
            Self::Baffle { .. } | Self::BareFrame => Some(Self::Unknown),
            Self::Coefficient { .. } | Self::Calibrated { .. } | Self::Unknown => None,
        }
    }

    /// The faces in air that the file states.
    pub(crate) const fn stated_faces(self) -> Option<Faces> {
        match self {
            Self::Baffle { faces } | Self::Coefficient { faces, .. } | Self::Calibrated { faces, .. } => {
                Some(faces)
            }
            Self::BareFrame | Self::Unknown => None,
        }
    }

    /// The share of the pressure at a distance, see `frequency/far_air.rs`.
    pub(crate) const fn distant(self) -> f64 {
        match self {
            Self::Baffle { .. } => 1.0,
            Self::BareFrame | Self::Coefficient { .. } => 0.0,
            Self::Unknown => 0.4,
            Self::Calibrated { distant, .. } => distant,
        }
    }

    /// Its standard deviation before a calibration; 0 where it is none of a calibration's business.
    pub(crate) const fn distant_deviation(self) -> f64 {
        match self {
            Self::Baffle { .. } | Self::BareFrame => 0.2,
            Self::Unknown | Self::Calibrated { .. } => 0.4,
            Self::Coefficient { .. } => 0.0,
        }
    }
}

impl Faces {
    /// How many they are.
    #[must_use]
    pub const fn count(self) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Two => 2.0,
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::One => Self::Two,
            Self::Two => Self::One,
        }
    }
}

impl Gas {
    /// Air of 20 degrees Celsius at the height of the sea.
    pub const ROOM: Self = Self::Atmosphere { temperature_c: 20.0, height_m: 0.0 };

    /// Density, kg/m^3: p/(R T) with p = 101 325 Pa (1 - 0.0065 height/288.15)^5.25588.
    #[must_use]
    pub fn density_kg_per_m3(self) -> f64 {
        match self {
            Self::Given { density_kg_per_m3, .. } => density_kg_per_m3,
            Self::Atmosphere { temperature_c, height_m } => {
                let (sea_level, fall) = STANDARD_K;
                let pressure = PRESSURE_PA * (1.0 - fall * height_m / sea_level).powf(EXPONENT);
                pressure / (GAS.0 * (temperature_c + ZERO_K))
            }
        }
    }

    /// Speed of sound, m/s: sqrt(1.4 R T).
    #[must_use]
    pub fn sound_speed_m_per_s(self) -> f64 {
        match self {
            Self::Given { sound_speed_m_per_s, .. } => sound_speed_m_per_s,
            Self::Atmosphere { temperature_c, .. } => (GAS.1 * GAS.0 * (temperature_c + ZERO_K)).sqrt(),
        }
    }
}

impl Air {
    /// Air of a room around a plate in a bare frame, which comes nearest to a frame on a table.
    pub const ROOM: Self = Self::Around { gas: Gas::ROOM, mounting: AirMounting::BareFrame, gap_m: None };

    /// The mounting of the plate in the air; `None` in a vacuum.
    #[must_use]
    pub fn mounting(&self) -> Option<AirMounting> {
        match self {
            Self::Vacuum => None,
            Self::Around { mounting, .. } => Some(*mounting),
        }
    }

    /// The share of the pressure at a distance: that of the mounting, and 0 above a table, which holds the pressure together itself.
    pub(crate) fn distant(&self) -> f64 {
        match self {
            Self::Around { mounting, gap_m: None, .. } => mounting.distant(),
            Self::Around { .. } | Self::Vacuum => 0.0,
        }
    }

    /// The same without the pressure at a distance.
    pub(crate) fn near_alone(self) -> Self {
        match self {
            Self::Vacuum => Self::Vacuum,
            Self::Around { gas, mounting, gap_m } => {
                let (alpha, faces) = mounting.coefficient();
                Self::Around { gas, mounting: AirMounting::Coefficient { alpha, faces }, gap_m }
            }
        }
    }

    pub(crate) fn validate(&self, model: &Model) -> Result<(), PlateError> {
        let Self::Around { mounting, gap_m, .. } = self else { return Ok(()) };
        if let (AirMounting::Baffle { .. }, Some(_)) = (mounting, gap_m) {
            let reason = "a baffle closes the gap to a table at its sides, and no law here has that air: leave the gap open";
            return Err(PlateError::unexpected("air.gap_m", reason));
        }
        if let Model::ShearHorizontal { .. } = model {
            let reason = "a shear-horizontal wave moves in its own plane and carries no air";
            return Err(PlateError::unexpected("air", reason));
        }
        model.surface_density("[air]").map(drop)
    }
}

/// What the air adds to the inertia of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AirLoad {
    /// faces alpha rho, kg/m^3.
    density: f64,
    alpha: f64,
    sound_speed: f64,
    /// Mass per area of the plate, kg/m^2.
    surface_density: f64,
    /// The table below.
    table: Option<Table>,
}

/// A table below a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Table {
    gap_m: f64,
    /// Share of the open air's mass on the lower face.
    share: f64,
}

impl Table {
    /// The mass of the air over that in the open, and d ln of that by d ln K, for K = `wavenumber`.
    fn factor(self, wavenumber: f64) -> (f64, f64) {
        let depth = wavenumber * self.gap_m;
        let factor = 1.0 - self.share + self.share / depth.tanh();
        // sinh overflows long after 1/sinh^2 has vanished.
        (factor, -self.share * depth / (depth.min(300.0).sinh().powi(2) * factor))
    }
}

impl AirLoad {
    /// The load of a valid [`Air`]; `None` where nothing is added.
    pub(crate) fn of(air: Option<&Air>, model: &Model) -> Option<Self> {
        let Some(Air::Around { gas, mounting, gap_m }) = air else { return None };
        let (alpha, faces) = mounting.coefficient();
        let table = |gap_m: f64| Table { gap_m, share: faces.count().recip() };
        Some(Self {
            density: faces.count() * alpha * gas.density_kg_per_m3(),
            alpha,
            sound_speed: gas.sound_speed_m_per_s(),
            surface_density: model.surface_density("[air]").ok()?,
            table: gap_m.map(table),
        })
    }

    pub(crate) const fn alpha(&self) -> f64 {
        self.alpha
    }

    /// The load of this alpha over `factor`.
    pub(crate) fn over(self, factor: f64) -> Self {
        Self { density: self.density / factor, alpha: self.alpha / factor, ..self }
    }

    /// mu over the plate's own mass per area, for K = `wavenumber` and the angular frequency `vacuum` that it has in vacuum;
    /// and d ln mu/d ln K where the latter is proportional to K^`power`.
    pub(crate) fn share(&self, wavenumber: f64, vacuum: f64, power: f64) -> (f64, f64) {
        let faster = (vacuum / (wavenumber * self.sound_speed * HALF_MASS)).powi(3);
        let share = self.density / (wavenumber * self.surface_density * (1.0 + faster));
        let fall = -1.0 - 3.0 * (power - 1.0) * faster / (1.0 + faster);
        self.table.map_or((share, fall), |table| {
            let (factor, rise) = table.factor(wavenumber);
            (share * factor, fall + rise)
        })
    }

    /// -(d ln mu/d ln K)/2 of a slow wave: a half in the open.
    pub(crate) fn half_fall(&self, wavenumber: f64) -> f64 {
        self.table.map_or(0.5, |table| 0.5 * (1.0 - table.factor(wavenumber).1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::special::gauss::gauss;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn the_standard_atmosphere_matches_its_tables() {
        // ISO 2533: height, temperature, density, speed of sound.
        for (height_m, kelvin, density, speed) in [
            (0.0, 288.15, 1.2250, 340.29),
            (1000.0, 281.65, 1.1117, 336.43),
            (5000.0, 255.65, 0.7361, 320.53),
        ] {
            let gas = Gas::Atmosphere { temperature_c: kelvin - ZERO_K, height_m };
            assert!((gas.density_kg_per_m3() - density).abs() < 2e-3, "{}", gas.density_kg_per_m3());
            assert!((gas.sound_speed_m_per_s() - speed).abs() < 0.02, "{}", gas.sound_speed_m_per_s());
        }
    }

    #[test]
    fn the_bare_frame_is_near_the_half_wave_strip_in_the_open() {
        // z = W cos t: the potential on the strip is the sum of a_n sin(n t) with n a_n = (2/pi) times the integral of
        // W cos(pi z/2W) sin t sin(n t), and both faces carry pi rho times the sum of n a_n^2 over the integral W of the
        // shape's square. That is 2 alpha rho/K with K = pi/2W.
        let total: f64 = (1..60)
            .map(|n| {
                let n = f64::from(n);
                let moved: f64 = gauss(200)
                    .into_iter()
                    .map(|(share, weight)| {
                        let t = PI * share;
                        PI * weight * (FRAC_PI_2 * t.cos()).cos() * t.sin() * (n * t).sin()
                    })
                    .sum();
                (2.0 / PI * moved).powi(2) / n
            })
            .sum();
        let alpha = PI * PI * total / 4.0;
        assert!((alpha - 1.342_45).abs() < 1e-5, "{alpha}");
        assert!((BARE_FRAME / alpha - 1.0).abs() < 0.08);
    }

    /// The half-wave across a strip |z| < W at the height g above a rigid wall. The potential jumps by sum b_n sin(n t), z = W cos t,
    /// which alone moves the strip by sum n b_n sin(n t)/(2 sin t); its image, mirrored in the wall, moves it by the integral of
    /// (x^2 - 4 g^2)/(2 pi (x^2 + 4 g^2)^2) over the jump. The mass follows from the jump that moves the strip by cos(pi z/2W).
    #[test]
    fn a_table_below_adds_the_mass_of_the_half_wave_strip_above_a_wall() {
        const ORDERS: usize = 24;
        let nodes: Vec<(f64, f64)> =
            gauss(200).into_iter().map(|(share, weight)| (PI * share, PI * weight)).collect();
        let mass = |gap: f64| -> f64 {
            let order = |n: usize| (n + 1) as f64;
            let matrix = nalgebra::DMatrix::from_fn(ORDERS, ORDERS, |row, n| {
                let t = (row as f64 + 0.5) * PI / ORDERS as f64;
                let image = |&(there, weight): &(f64, f64)| {
                    let (x2, g2) = ((t.cos() - there.cos()).powi(2), 4.0 * gap * gap);
                    let kernel = (x2 - g2) / (x2 + g2).powi(2) / (2.0 * PI);
                    kernel * (order(n) * there).sin() * there.sin() * weight
                };
                0.5 * order(n) * (order(n) * t).sin() / t.sin() + nodes.iter().map(image).sum::<f64>()
            });
            let moves = |t: f64| (FRAC_PI_2 * t.cos()).cos();
            let wanted =
                nalgebra::DVector::from_fn(ORDERS, |row, _| moves((row as f64 + 0.5) * PI / ORDERS as f64));
            let jump = matrix.lu().solve(&wanted).expect("regular");
            let (mut above, mut below) = (0.0, 0.0);
            for &(t, weight) in &nodes {
                let here: f64 = (0..ORDERS).map(|n| jump[n] * (order(n) * t).sin()).sum();
                above += weight * t.sin() * here * moves(t);
                below += weight * t.sin() * moves(t).powi(2);
            }
            // Over rho/K of K = pi/2W.
            FRAC_PI_2 * above / below
        };
        let open = mass(1e3);
        assert!((open / 2.0 - 1.342_45).abs() < 1e-3, "{open}");
        for (gap, within) in [(2.0, 0.03), (1.0, 0.06), (0.5, 0.04), (0.3, 0.01), (0.2, 0.06), (0.1, 0.14)] {
            let table = Table { gap_m: gap, share: 0.5 };
            let by_law = open * table.factor(FRAC_PI_2).0;
            let found = mass(gap);
            assert!((by_law / found - 1.0).abs() < within, "{gap}: {by_law} {found}");
        }
        // The slope is that of the factor.
        let table = Table { gap_m: 0.01, share: 0.5 };
        let [(near, _), (far, _)] = [99.9, 100.1].map(|k| table.factor(k));
        let (_, slope) = table.factor(100.0);
        assert!(((far / near).ln() / (100.1_f64 / 99.9).ln() / slope - 1.0).abs() < 1e-4, "{slope}");
    }
}
