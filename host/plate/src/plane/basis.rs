//! The basis functions of the deflection: polynomials across the width, cubic Hermite elements along the plate.

/// Value, first and second derivative of a function at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jet {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) bend: f64,
}

/// Conditions that the deflection satisfies exactly at the edges z = +-W.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edges {
    /// Deflection zero: a fixed membrane, or a simply supported plate, whose moment vanishes by the weak form.
    Supported,
    /// Deflection and slope zero.
    Clamped,
    /// Deflection zero, of a clamped plate whose edges turn against a spring, which is a term of the energy.
    Turning,
}

/// (1 - b^2)^e P_2m(b) at b = z/W with e = 2 for clamped edges and 1 for all others: symmetric in z.
pub(super) fn across(edges: Edges, order: usize, b: f64) -> Jet {
    let legendre = legendre(2 * order, b);
    let gap = 1.0 - b * b;
    let window = match edges {
        Edges::Supported | Edges::Turning => Jet { value: gap, slope: -2.0 * b, bend: -2.0 },
        Edges::Clamped => Jet { value: gap * gap, slope: -4.0 * b * gap, bend: 12.0 * b * b - 4.0 },
    };
    Jet {
        value: window.value * legendre.value,
        slope: window.slope * legendre.value + window.value * legendre.slope,
        bend: window.bend * legendre.value
            + 2.0 * window.slope * legendre.slope
            + window.value * legendre.bend,
    }
}

/// Legendre polynomial P_n with its derivatives, by n P_n = (2n - 1) b P_(n-1) - (n - 1) P_(n-2).
fn legendre(degree: usize, b: f64) -> Jet {
    let mut before = Jet { value: 0.0, slope: 0.0, bend: 0.0 };
    let mut now = Jet { value: 1.0, slope: 0.0, bend: 0.0 };
    for n in 1..=degree {
        let n = n as f64;
        let (a, c) = ((2.0 * n - 1.0) / n, (n - 1.0) / n);
        let next = Jet {
            value: a * b * now.value - c * before.value,
            slope: a * (now.value + b * now.slope) - c * before.slope,
            bend: a * (2.0 * now.slope + b * now.bend) - c * before.bend,
        };
        (before, now) = (now, next);
    }
    now
}

/// The four cubics of an element of length `h` at t = 0..1, each as value, first and second derivative along x. Their
/// coefficients are the value at the element's start, the slope there times `unit`, and the same at its end; with a
/// `unit` near h the unknowns are of one size.
pub(super) fn along(t: f64, h: f64, unit: f64) -> [[f64; 3]; 4] {
    let jet = |c0: f64, c1: f64, c2: f64, c3: f64| {
        [
            c0 + t * (c1 + t * (c2 + t * c3)),
            (c1 + t * (2.0 * c2 + 3.0 * t * c3)) / h,
            (2.0 * c2 + 6.0 * t * c3) / (h * h),
        ]
    };
    let u = h / unit;
    [jet(1.0, 0.0, -3.0, 2.0), jet(0.0, u, -2.0 * u, u), jet(0.0, 0.0, 3.0, -2.0), jet(0.0, 0.0, -u, u)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_the_functions() {
        let step = 1e-5;
        let check = |f: &dyn Fn(f64) -> Jet, at: f64, scale: f64| {
            let (low, here, high) = (f(at - step), f(at), f(at + step));
            let slope = (high.value - low.value) / (2.0 * step) / scale;
            let bend = (high.slope - low.slope) / (2.0 * step) / scale;
            assert!((slope - here.slope).abs() < 1e-6 * (1.0 + here.slope.abs()), "{slope} {here:?}");
            assert!((bend - here.bend).abs() < 1e-6 * (1.0 + here.bend.abs()), "{bend} {here:?}");
        };
        for edges in [Edges::Supported, Edges::Clamped] {
            for order in 0..5 {
                check(&|b| across(edges, order, b), 0.37, 1.0);
            }
        }
        for number in 0..4 {
            let cubic = |t: f64| {
                let [value, slope, bend] = along(t, 0.2, 0.3)[number];
                Jet { value, slope, bend }
            };
            check(&cubic, 0.61, 0.2);
        }
    }

    #[test]
    fn the_slopes_of_an_element_are_counted_in_the_unit() {
        let (start, end) = (along(0.0, 0.2, 0.3), along(1.0, 0.2, 0.3));
        assert!((start[1][1] * 0.3 - 1.0).abs() < 1e-12 && (end[3][1] * 0.3 - 1.0).abs() < 1e-12);
    }
}
