//! Vectors of sixteen numbers on any instruction set.
//!
//! [`Work`] is written once with the operations of [`Lanes`] and compiled for each instruction set; [`Width::run`]
//! uses the widest of the machine. Products and sums are [`Fused`] where that is written, and a fused operation rounds
//! alike on every machine, so all processors and all widths compute the same bits. (Those without a fused
//! multiply-add, such as x86 before 2013, are slow.)

use crate::fused::Fused;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use std::array::from_fn;

/// Numbers per vector (16 `f32` = 512 bits).
pub(super) const LANES: usize = 16;

/// A vector in memory; fields are aligned so that each vector is one cache line.
pub(super) type Line = [f32; LANES];

/// The operations on vectors.
pub(super) trait Lanes: Copy {
    type Vector: Copy;

    fn splat(self, value: f32) -> Self::Vector;
    fn load(self, line: &Line) -> Self::Vector;
    fn store(self, vector: Self::Vector, line: &mut Line);
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn multiply(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// a b + c, [`Fused`].
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// a b - c, [`Fused`].
    fn multiply_subtract(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// The larger of |a| and b; b if a is NaN.
    fn larger_magnitude(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Moves every number one lane up; lane 0 takes the last lane of `before`.
    fn up(self, before: Self::Vector, vector: Self::Vector) -> Self::Vector;
    /// Moves every number one lane down; the last lane takes lane 0 of `after`.
    fn down(self, vector: Self::Vector, after: Self::Vector) -> Self::Vector;
}

/// Plain Rust, which the compiler vectorises for its instruction set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plain;

impl Lanes for Plain {
    type Vector = [f32; LANES];

    #[inline(always)]
    fn splat(self, value: f32) -> [f32; LANES] {
        [value; LANES]
    }

    #[inline(always)]
    fn load(self, line: &Line) -> [f32; LANES] {
        *line
    }

    #[inline(always)]
    fn store(self, vector: [f32; LANES], line: &mut Line) {
        *line = vector;
    }

    #[inline(always)]
    fn add(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn multiply(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| a[lane] * b[lane])
    }

    #[inline(always)]
    fn multiply_add(self, a: [f32; LANES], b: [f32; LANES], c: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| a[lane].fused(b[lane], c[lane]))
    }

    #[inline(always)]
    fn multiply_subtract(self, a: [f32; LANES], b: [f32; LANES], c: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| a[lane].fused(b[lane], -c[lane]))
    }

    #[inline(always)]
    fn larger_magnitude(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| if a[lane].abs() > b[lane] { a[lane].abs() } else { b[lane] })
    }

    #[inline(always)]
    fn up(self, before: [f32; LANES], vector: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| if lane == 0 { before[LANES - 1] } else { vector[lane - 1] })
    }

    #[inline(always)]
    fn down(self, vector: [f32; LANES], after: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| if lane == LANES - 1 { after[0] } else { vector[lane + 1] })
    }
}

/// AVX-512, where a move across lanes is one instruction.
#[cfg(target_arch = "x86_64")]
impl Lanes for V4 {
    type Vector = core::arch::x86_64::__m512;

    #[inline(always)]
    fn splat(self, value: f32) -> Self::Vector {
        self.avx512f._mm512_set1_ps(value)
    }

    #[inline(always)]
    fn load(self, line: &Line) -> Self::Vector {
        pulp::cast(*line)
    }

    #[inline(always)]
    fn store(self, vector: Self::Vector, line: &mut Line) {
        *line = pulp::cast(vector);
    }

    #[inline(always)]
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        self.avx512f._mm512_add_ps(a, b)
    }

    #[inline(always)]
    fn multiply(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        self.avx512f._mm512_mul_ps(a, b)
    }

    #[inline(always)]
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        self.avx512f._mm512_fmadd_ps(a, b, c)
    }

    #[inline(always)]
    fn multiply_subtract(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        self.avx512f._mm512_fmsub_ps(a, b, c)
    }

    #[inline(always)]
    fn larger_magnitude(self, a: Self::Vector, b: Self::Vector) -> Self::Vector {
        self.avx512f._mm512_max_ps(self.avx512f._mm512_abs_ps(a), b)
    }

    #[inline(always)]
    fn up(self, before: Self::Vector, vector: Self::Vector) -> Self::Vector {
        pulp::cast(self.avx512f._mm512_alignr_epi32::<15>(pulp::cast(vector), pulp::cast(before)))
    }

    #[inline(always)]
    fn down(self, vector: Self::Vector, after: Self::Vector) -> Self::Vector {
        pulp::cast(self.avx512f._mm512_alignr_epi32::<1>(pulp::cast(after), pulp::cast(vector)))
    }
}

/// A computation with vectors. All its functions must be `#[inline(always)]`: a function that is not inlined is
/// compiled without the instruction set.
pub(super) trait Work {
    fn with<L: Lanes>(self, lanes: L);
}

/// The instruction set of a computation.
#[derive(Debug, Clone, Copy)]
pub(super) enum Width {
    /// The basic instructions of the target architecture.
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
}

impl Width {
    /// The widest instruction set of this machine.
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(token) = V4::try_new() {
                return Self::Avx512(token);
            }
            if let Some(token) = V3::try_new() {
                return Self::Avx2(token);
            }
        }
        Self::Portable
    }

    /// All instruction sets of this machine.
    #[cfg(test)]
    pub(super) fn all() -> Vec<Self> {
        let mut all = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        all.extend(V3::try_new().map(Self::Avx2).into_iter().chain(V4::try_new().map(Self::Avx512)));
        all
    }

    /// Runs the computation compiled for this instruction set.
    pub(super) fn run(self, work: impl Work) {
        match self {
            Self::Portable => work.with(Plain),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(token) => token.vectorize(
                #[inline(always)]
                || work.with(Plain),
            ),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(token) => token.vectorize(
                #[inline(always)]
                || work.with(token),
            ),
        }
    }
}
