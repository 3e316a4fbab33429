//! The Airy function Ai and the constants of its edge.

/// Distance of the peak before the turning point, in units of 1/kappa.
pub const PEAK_OFFSET: f64 = 1.018_792_971_647_471;
/// Distance from the peak to a tenth of it, in units of 1/kappa (1.018793 + 1.709808).
pub const EDGE_WIDTH: f64 = 2.728_6;
/// First nodes of Ai, in units of 1/kappa from the turning point.
pub(crate) const NODES: [f64; 4] =
    [-2.338_107_410_459_767, -4.087_949_444_130_971, -5.520_559_828_095_551, -6.786_708_090_071_759];
/// Ai at its peak.
pub const PEAK_VALUE: f64 = 0.535_656_656_015_700;

/// Ai(z) for real z, relative error below 1e-9 within -25..25 (absolute below the nodes).
///
/// Power series (DLMF 9.4.1) near 0, the asymptotic series (DLMF 9.7.5 and 9.7.9) far from it.
pub fn ai(z: f64) -> f64 {
    if z > 6.5 {
        return tail(z);
    }
    if z < -8.5 {
        return oscillation(z);
    }
    let (c1, c2) = (0.355_028_053_887_817_2, 0.258_819_403_792_806_8);
    let cube = z * z * z;
    let (mut f, mut g) = (1.0, z);
    let (mut term_f, mut term_g) = (1.0, z);
    for k in 1..80 {
        let n = 3.0 * f64::from(k);
        term_f *= cube / (n * (n - 1.0));
        term_g *= cube / (n * (n + 1.0));
        f += term_f;
        g += term_g;
        if term_f.abs() < 1e-18 * f.abs() && term_g.abs() < 1e-18 * g.abs() {
            break;
        }
    }
    c1 * f - c2 * g
}

/// u_k of DLMF 9.7.2.
fn asymptotic_terms() -> [f64; 12] {
    let mut u = [1.0; 12];
    for k in 1..12 {
        let n = k as f64;
        u[k] = u[k - 1] * (6.0 * n - 5.0) * (6.0 * n - 3.0) * (6.0 * n - 1.0) / ((2.0 * n - 1.0) * 216.0 * n);
    }
    u
}

fn tail(z: f64) -> f64 {
    let zeta = 2.0 / 3.0 * z * z.sqrt();
    let mut sum = 0.0;
    let mut power = 1.0;
    for u in asymptotic_terms() {
        sum += u * power;
        power /= -zeta;
    }
    (-zeta).exp() / (2.0 * std::f64::consts::PI.sqrt() * z.sqrt().sqrt()) * sum
}

fn oscillation(z: f64) -> f64 {
    let x = -z;
    let zeta = 2.0 / 3.0 * x * x.sqrt();
    let (mut even, mut odd) = (0.0, 0.0);
    let mut power = 1.0;
    for (k, u) in asymptotic_terms().into_iter().enumerate() {
        let sign = if (k / 2) % 2 == 0 { 1.0 } else { -1.0 };
        if k % 2 == 0 {
            even += sign * u * power;
        } else {
            odd += sign * u * power;
        }
        power /= zeta;
    }
    let phase = zeta - std::f64::consts::FRAC_PI_4;
    (phase.cos() * even + phase.sin() * odd) / (std::f64::consts::PI.sqrt() * x.sqrt().sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ai_has_its_tabulated_values() {
        // DLMF and Abramowitz & Stegun table 10.11.
        for (z, value) in
            [(0.0, 0.355_028_053_9), (1.0, 0.135_292_416_3), (-2.0, 0.227_407_428_2), (5.0, 1.083_444_281e-4)]
        {
            assert!((ai(z) / value - 1.0).abs() < 1e-8, "Ai({z}) = {}", ai(z));
        }
        assert!((ai(10.0) / 1.104_753_255e-10 - 1.0).abs() < 1e-8);
        assert!((ai(-10.0) - 0.040_241_238_5).abs() < 1e-9);
        assert!((ai(6.5 + 1e-9) / ai(6.5 - 1e-9) - 1.0).abs() < 1e-6, "the two series meet");
        assert!((ai(-8.5 + 1e-9) - ai(-8.5 - 1e-9)).abs() < 1e-7);
    }

    #[test]
    fn nodes_and_the_peak_lie_where_the_constants_say() {
        for node in NODES {
            assert!(ai(node).abs() < 1e-9, "Ai({node})");
        }
        assert!((ai(-PEAK_OFFSET) - PEAK_VALUE).abs() < 1e-9);
        let h = 1e-4;
        assert!(ai(-PEAK_OFFSET - h) < PEAK_VALUE && ai(-PEAK_OFFSET + h) < PEAK_VALUE);
        assert!((ai(0.0) / PEAK_VALUE - 0.6628).abs() < 1e-4);
    }

    /// Place beyond the peak where Ai falls to `level` times its peak.
    fn place_of_level(level: f64) -> f64 {
        let (mut low, mut high) = (-PEAK_OFFSET, 10.0);
        for _ in 0..70 {
            let middle = 0.5 * (low + high);
            if ai(middle) > level * PEAK_VALUE { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    #[test]
    fn levels_past_the_peak_are_the_edge_table() {
        for (level, place) in [(0.5, 0.345), (0.25, 1.009), (0.10, 1.710), (0.05, 2.172), (0.01, 3.114)] {
            let found = place_of_level(level);
            assert!((found - place).abs() < 6e-4, "{level}: {found}");
        }
        assert!((place_of_level(0.1) + PEAK_OFFSET - EDGE_WIDTH).abs() < 2e-4);
    }
}
