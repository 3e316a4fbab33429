//! The frame that holds a plate, as its file states it.

/// Free length of the window before the driven end, metres.
pub(crate) const DRIVE_GAP_M: f64 = 0.015;

/// The frame of a plate, `[frame]` of a plate file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Young's modulus of its material, Pa (1000 to 1e13).
    pub youngs_modulus_pa: f64,
    /// Density of its material, kg/m^3 (1 to 30 000).
    pub density_kg_per_m3: f64,
    /// Thickness of both sheets together, metres (0.001 to 0.2).
    pub thickness_m: f64,
    /// Width of the rim around the window, metres (0.01 to 0.5).
    pub rim_m: f64,
    /// Mass of the table to which it is screwed, kg (0 to 1000); 0 for a frame that lies free.
    pub table_mass_kg: f64,
}
