//! A small library of sheet materials.
//!
//! Handbook values at room temperature. The loss factors are illustrative, because mounting and glue often lose more
//! energy than the material: measure two boundaries on your plate and calibrate.

use crate::definition::error::PlateError;
use crate::definition::limits;
use crate::quantity::hint;
use serde::Serialize;

/// A sheet material.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Material {
    /// The name that selects it.
    pub name: String,
    /// Young's modulus E, Pa (1000 to 1e13).
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio nu (0 to 0.499).
    pub poisson_ratio: f64,
    /// Density rho, kg/m^3 (1 to 30 000).
    pub density_kg_per_m3: f64,
    /// Loss factor (0 to 0.5).
    pub loss_factor: f64,
}

/// Name, E in GPa, nu, rho in kg/m^3, loss factor.
const LIBRARY: [(&str, f64, f64, f64, f64); 11] = [
    ("aluminium", 70.0, 0.33, 2700.0, 0.002),
    ("steel", 200.0, 0.29, 7850.0, 0.002),
    ("stainless-steel", 193.0, 0.30, 8000.0, 0.002),
    ("brass", 100.0, 0.34, 8500.0, 0.002),
    ("glass", 70.0, 0.22, 2500.0, 0.002),
    ("fr4", 22.0, 0.15, 1850.0, 0.02),
    ("acrylic", 3.2, 0.37, 1190.0, 0.05),
    ("polycarbonate", 2.3, 0.37, 1200.0, 0.02),
    ("polyester-film", 4.5, 0.38, 1390.0, 0.02),
    ("silicone-rubber", 0.002, 0.49, 1100.0, 0.1),
    ("latex", 0.0015, 0.49, 950.0, 0.05),
];

/// Names of the library's materials.
pub fn material_names() -> impl Iterator<Item = &'static str> {
    LIBRARY.iter().map(|entry| entry.0)
}

impl Material {
    /// The library's material called `name`.
    ///
    /// # Errors
    /// [`PlateError::UnknownKind`], with all names of the library, if there is no such material.
    pub fn named(name: &str) -> Result<Self, PlateError> {
        let Some(&(name, gigapascal, poisson_ratio, density_kg_per_m3, loss_factor)) =
            LIBRARY.iter().find(|entry| entry.0 == name)
        else {
            let allowed: Vec<String> = material_names().map(|name| format!("\"{name}\"")).collect();
            return Err(PlateError::UnknownKind {
                field: "material".to_owned(),
                value: format!("\"{}\"", name.chars().take(40).collect::<String>()),
                allowed: format!("one of {}{}", allowed.join(", "), hint(name, material_names())),
            });
        };
        Ok(Self {
            name: name.to_owned(),
            youngs_modulus_pa: gigapascal * 1e9,
            poisson_ratio,
            density_kg_per_m3,
            loss_factor,
        })
    }

    /// Shear modulus mu = E/(2 (1 + nu)), Pa.
    pub fn shear_modulus_pa(&self) -> f64 {
        self.youngs_modulus_pa / (2.0 * (1.0 + self.poisson_ratio))
    }

    pub(super) fn validate(&self) -> Result<(), PlateError> {
        limits::YOUNGS_MODULUS.check("material.youngs_modulus_pa", self.youngs_modulus_pa)?;
        limits::POISSON_RATIO.check("material.poisson_ratio", self.poisson_ratio)?;
        limits::DENSITY.check("material.density_kg_per_m3", self.density_kg_per_m3)?;
        limits::LOSS_FACTOR.check("material.loss_factor", self.loss_factor)
    }
}
