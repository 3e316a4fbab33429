//! The inner loops of the sheet: one row of the leapfrog update, at the widest vectors this machine has.
//!
//! The loops are plain Rust that the compiler turns into vectors, compiled once for each instruction set. Only the
//! widest, [`advance_pair`] with AVX-512, is written in vectors: it takes the left and right neighbours out of
//! registers, because at 512 bits nearly every load that is off by one number touches two cache lines. Three of the
//! four multiplications are fused with an addition; that rounds the same way wherever it is computed, so every machine
//! and every width gives the same bits. (A machine without the instruction, as x86 had before 2013, is slow.)
//!
//! This is the one file of the crate with `unsafe`: calling a function that was compiled for an instruction set
//! needs the promise that the machine has it, and [`Width`] is that promise.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{
    __m512, _mm512_add_ps, _mm512_alignr_epi32, _mm512_castps_si512, _mm512_castsi512_ps, _mm512_fmadd_ps,
    _mm512_fnmadd_ps, _mm512_loadu_ps, _mm512_mul_ps, _mm512_set1_ps, _mm512_storeu_ps,
};

/// Numbers per widest vector (16 `f32` = 512 bits): rows start and spans end on multiples of it.
pub(super) const LANES: usize = 16;

/// The widest instruction set that may be used; only [`Width::detect`] makes anything but the portable one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Width(Vectors);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Vectors {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Width {
    /// What every machine of the target architecture has.
    #[cfg(test)]
    pub(super) fn portable() -> Self {
        Self(Vectors::Portable)
    }

    /// The widest that this machine has.
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") {
                return Self(Vectors::Avx512);
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self(Vectors::Avx2);
            }
        }
        Self(Vectors::Portable)
    }
}

/// The four numbers of the update `next = own v - past before + along (left + right) + across (above + below)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Weights {
    pub(super) own: f32,
    pub(super) past: f32,
    pub(super) along: f32,
    pub(super) across: f32,
}

impl Weights {
    /// The number after `past`, with `own` as the cell's own weight.
    #[inline(always)]
    fn next(self, own: f32, value: f32, past: f32, beside: f32, across: f32) -> f32 {
        own.mul_add(value, self.along.mul_add(beside, (-self.past).mul_add(past, self.across * across)))
    }
}

/// Compiles `$body` for each instruction set and calls the one that `width` names.
macro_rules! at_each_width {
    ($(#[$doc:meta])* $name:ident = $body:ident($($argument:ident: $kind:ty),*)) => {
        $(#[$doc])*
        pub(super) fn $name(width: Width, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($argument: $kind),*) {
                $body($($argument),*);
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f")]
            fn avx512($($argument: $kind),*) {
                $body($($argument),*);
            }
            match width.0 {
                Vectors::Portable => $body($($argument),*),
                #[cfg(target_arch = "x86_64")]
                #[expect(unsafe_code, reason = "the instruction set is known only at run time")]
                // SAFETY: only `Width::detect` makes this value, after the machine said that it has AVX2 and FMA.
                Vectors::Avx2 => unsafe { avx2($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                #[expect(unsafe_code, reason = "the instruction set is known only at run time")]
                // SAFETY: only `Width::detect` makes this value, after the machine said that it has AVX-512F.
                Vectors::Avx512 => unsafe { avx512($($argument),*) },
            }
        }
    };
}

at_each_width! {
    /// Advances `past` (which holds the row one step before `row`) to the row one step after it.
    ///
    /// `row` has one more cell on either side than `past`; `above` and `below` are the same length as `past`.
    advance = advance_body(past: &mut [f32], row: &[f32], above: &[f32], below: &[f32], weights: Weights)
}

at_each_width! {
    /// As [`advance`], with an own weight for every cell: cells whose neighbour is the plate's edge.
    advance_edge = advance_edge_body(
        past: &mut [f32], row: &[f32], above: &[f32], below: &[f32], own: &[f32], weights: Weights
    )
}

at_each_width! {
    /// Takes a row into the envelope: the largest magnitude and the sum of squares of every cell.
    record = record_body(row: &[f32], maximum: &mut [f32], squares: &mut [f64])
}

at_each_width! {
    /// Sets to zero what is too small to matter, before it becomes a denormal number that costs a hundred cycles.
    hush = hush_body(row: &mut [f32])
}

/// The rows around a pair: `above`, `first`, `second`, `below`, of which the middle two have [`LANES`] more numbers on
/// either side than the outer ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around<'a> {
    pub(super) above: &'a [f32],
    pub(super) first: &'a [f32],
    pub(super) second: &'a [f32],
    pub(super) below: &'a [f32],
}

/// As [`advance`] on two neighbouring rows at once, which share half of what they read.
///
/// All rows of `around` must be as long as its type says; `past` holds a multiple of [`LANES`] cells.
pub(super) fn advance_pair(width: Width, past: [&mut [f32]; 2], around: Around<'_>, weights: Weights) {
    #[cfg(target_arch = "x86_64")]
    if width.0 == Vectors::Avx512 {
        #[expect(unsafe_code, reason = "the instruction set is known only at run time")]
        // SAFETY: only `Width::detect` makes this value, after the machine said that it has AVX-512F.
        unsafe {
            pair_avx512(past, around, weights);
        }
        return;
    }
    let [first, second] = past;
    pair(width, first, second, around, weights);
}

at_each_width! {
    pair = pair_body(first: &mut [f32], second: &mut [f32], around: Around<'_>, weights: Weights)
}

/// Two rows, 16 cells at a time.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn pair_avx512(past: [&mut [f32]; 2], around: Around<'_>, weights: Weights) {
    let [past_first, past_second] = past;
    let cells = past_first.len();
    assert!(
        cells.is_multiple_of(LANES)
            && past_second.len() == cells
            && around.above.len() == cells
            && around.below.len() == cells
            && around.first.len() == cells + 2 * LANES
            && around.second.len() == cells + 2 * LANES,
        "rows of a pair do not fit together"
    );
    let own = _mm512_set1_ps(weights.own);
    let past_weight = _mm512_set1_ps(weights.past);
    let along = _mm512_set1_ps(weights.along);
    let across = _mm512_set1_ps(weights.across);
    let next = |past: __m512, own_value: __m512, sides: __m512, above: __m512, below: __m512| {
        let vertical = _mm512_mul_ps(across, _mm512_add_ps(above, below));
        let others = _mm512_fmadd_ps(along, sides, _mm512_fnmadd_ps(past_weight, past, vertical));
        _mm512_fmadd_ps(own, own_value, others)
    };
    // left + right of the middle one of three neighbouring vectors.
    let sides = |before: __m512, middle: __m512, after: __m512| {
        let (before, middle, after) =
            (_mm512_castps_si512(before), _mm512_castps_si512(middle), _mm512_castps_si512(after));
        let left = _mm512_castsi512_ps(_mm512_alignr_epi32::<15>(middle, before));
        let right = _mm512_castsi512_ps(_mm512_alignr_epi32::<1>(after, middle));
        _mm512_add_ps(left, right)
    };
    #[expect(unsafe_code, reason = "vector loads and stores take pointers")]
    // SAFETY: `at` is a multiple of LANES below `cells`. So a load of LANES numbers at `at` (at most `cells` - LANES)
    // is inside the four rows of `cells` numbers, and one at `at` + 2 LANES (at most `cells` + LANES) inside the two
    // rows with margins, as the assertion above has checked; loads and stores need no alignment, and the `&mut` rows
    // overlap nothing.
    unsafe {
        let load = |row: &[f32], at: usize| _mm512_loadu_ps(row.as_ptr().add(at));
        let (mut first_before, mut first) = (load(around.first, 0), load(around.first, LANES));
        let (mut second_before, mut second) = (load(around.second, 0), load(around.second, LANES));
        for at in (0..cells).step_by(LANES) {
            let first_after = load(around.first, at + 2 * LANES);
            let second_after = load(around.second, at + 2 * LANES);
            let (above, below) = (load(around.above, at), load(around.below, at));
            let first_sides = sides(first_before, first, first_after);
            let second_sides = sides(second_before, second, second_after);
            let upper = next(load(past_first, at), first, first_sides, above, second);
            let lower = next(load(past_second, at), second, second_sides, first, below);
            _mm512_storeu_ps(past_first.as_mut_ptr().add(at), upper);
            _mm512_storeu_ps(past_second.as_mut_ptr().add(at), lower);
            (first_before, first) = (first, first_after);
            (second_before, second) = (second, second_after);
        }
    }
}

#[inline(always)]
fn pair_body(first: &mut [f32], second: &mut [f32], around: Around<'_>, weights: Weights) {
    let cells = first.len();
    let second = &mut second[..cells];
    // Without the margins, but for one cell.
    let (upper, lower) = (&around.first[LANES - 1..], &around.second[LANES - 1..]);
    let (upper_left, upper_own, upper_right) = (&upper[..cells], &upper[1..cells + 1], &upper[2..cells + 2]);
    let (lower_left, lower_own, lower_right) = (&lower[..cells], &lower[1..cells + 1], &lower[2..cells + 2]);
    let (above, below) = (&around.above[..cells], &around.below[..cells]);
    for i in 0..cells {
        let beside = upper_left[i] + upper_right[i];
        let one = weights.next(weights.own, upper_own[i], first[i], beside, above[i] + lower_own[i]);
        let beside = lower_left[i] + lower_right[i];
        let two = weights.next(weights.own, lower_own[i], second[i], beside, upper_own[i] + below[i]);
        first[i] = one;
        second[i] = two;
    }
}

#[inline(always)]
fn advance_body(past: &mut [f32], row: &[f32], above: &[f32], below: &[f32], weights: Weights) {
    let cells = past.len();
    let (left, own, right) = (&row[..cells], &row[1..cells + 1], &row[2..cells + 2]);
    let (above, below) = (&above[..cells], &below[..cells]);
    for i in 0..cells {
        past[i] = weights.next(weights.own, own[i], past[i], left[i] + right[i], above[i] + below[i]);
    }
}

#[inline(always)]
fn advance_edge_body(
    past: &mut [f32],
    row: &[f32],
    above: &[f32],
    below: &[f32],
    own_weight: &[f32],
    weights: Weights,
) {
    let cells = past.len();
    let (left, own, right) = (&row[..cells], &row[1..cells + 1], &row[2..cells + 2]);
    let (above, below, own_weight) = (&above[..cells], &below[..cells], &own_weight[..cells]);
    for i in 0..cells {
        past[i] = weights.next(own_weight[i], own[i], past[i], left[i] + right[i], above[i] + below[i]);
    }
}

#[inline(always)]
fn record_body(row: &[f32], maximum: &mut [f32], squares: &mut [f64]) {
    let cells = row.len();
    let (maximum, squares) = (&mut maximum[..cells], &mut squares[..cells]);
    for i in 0..cells {
        let magnitude = row[i].abs();
        maximum[i] = if magnitude > maximum[i] { magnitude } else { maximum[i] };
        squares[i] += f64::from(row[i]) * f64::from(row[i]);
    }
}

#[inline(always)]
fn hush_body(row: &mut [f32]) {
    for value in row {
        *value = if value.abs() < 1e-30 { 0.0 } else { *value };
    }
}
