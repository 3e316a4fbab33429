//! The inner loops of the sheet: one row of the leapfrog update, at the widest vectors this machine has.
//!
//! Every loop is plain Rust that the compiler turns into vectors; it is compiled once for each instruction set. No
//! multiplication is fused with an addition, so every machine and every width gives the same bits.
//!
//! This is the one file of the crate with `unsafe`: calling a function that was compiled for an instruction set
//! needs the promise that the machine has it, and [`Width`] is that promise.

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
            if is_x86_feature_detected!("avx2") {
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

/// Compiles `$body` for each instruction set and calls the one that `width` names.
macro_rules! at_each_width {
    ($(#[$doc:meta])* $name:ident = $body:ident($($argument:ident: $kind:ty),*)) => {
        $(#[$doc])*
        pub(super) fn $name(width: Width, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
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
                // SAFETY: only `Width::detect` makes this value, after the machine said that it has AVX2.
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

#[inline(always)]
fn advance_body(past: &mut [f32], row: &[f32], above: &[f32], below: &[f32], weights: Weights) {
    let cells = past.len();
    let (left, own, right) = (&row[..cells], &row[1..cells + 1], &row[2..cells + 2]);
    let (above, below) = (&above[..cells], &below[..cells]);
    for i in 0..cells {
        past[i] = (weights.own * own[i] - weights.past * past[i])
            + (weights.along * (left[i] + right[i]) + weights.across * (above[i] + below[i]));
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
        past[i] = (own_weight[i] * own[i] - weights.past * past[i])
            + (weights.along * (left[i] + right[i]) + weights.across * (above[i] + below[i]));
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
