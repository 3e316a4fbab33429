//! Sixteen numbers at a time, on whatever instruction set the machine has.
//!
//! [`Work`] is written once, with the operations of [`Lanes`], and compiled for each instruction set; [`Width::run`]
//! takes the widest that the machine has. Products are fused with sums where the code says so, which rounds the same
//! way wherever it is computed: every machine and every width gives the same bits. (A machine without the
//! instruction, as x86 had before 2013, is slow.)

#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use std::array::from_fn;

/// Numbers per vector (16 `f32` = 512 bits).
pub(super) const LANES: usize = 16;

/// A vector in memory; fields are laid out so that it is one cache line.
pub(super) type Line = [f32; LANES];

/// What is done with vectors.
pub(super) trait Lanes: Copy {
    type Vector: Copy;

    fn splat(self, value: f32) -> Self::Vector;
    fn load(self, line: &Line) -> Self::Vector;
    fn store(self, vector: Self::Vector, line: &mut Line);
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    fn multiply(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// a b + c, rounded once.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// a b - c, rounded once.
    fn multiply_subtract(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// The larger of |a| and b; b if a is no number.
    fn larger_magnitude(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Every number one lane up; lane 0 takes the last lane of `before`.
    fn up(self, before: Self::Vector, vector: Self::Vector) -> Self::Vector;
    /// Every number one lane down; the last lane takes lane 0 of `after`.
    fn down(self, vector: Self::Vector, after: Self::Vector) -> Self::Vector;
}

/// Plain Rust, which the compiler transfers into the vectors of the instruction set it compiles for.
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
        from_fn(|lane| a[lane].mul_add(b[lane], c[lane]))
    }

    #[inline(always)]
    fn multiply_subtract(self, a: [f32; LANES], b: [f32; LANES], c: [f32; LANES]) -> [f32; LANES] {
        from_fn(|lane| a[lane].mul_add(b[lane], -c[lane]))
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

/// Something to be done with vectors. Everything down to the last loop must be `#[inline(always)]`: what is not
/// inlined is compiled without the instruction set.
pub(super) trait Work {
    fn with<L: Lanes>(self, lanes: L);
}

/// The widest instruction set that may be used.
#[derive(Debug, Clone, Copy)]
pub(super) enum Width {
    /// What every machine of the target architecture has.
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
}

impl Width {
    /// The widest that this machine has.
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

    /// All that this machine has.
    #[cfg(test)]
    pub(super) fn all() -> Vec<Self> {
        let mut all = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        all.extend(V3::try_new().map(Self::Avx2).into_iter().chain(V4::try_new().map(Self::Avx512)));
        all
    }

    /// Does the work, compiled for this width.
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
