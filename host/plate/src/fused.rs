//! Products and sums, rounded once where the machine has an instruction for it.

/// Numbers of the kernels.
pub(crate) trait Fused {
    /// a b + c. Rounded once, alike on every processor. WebAssembly has no instruction that rounds once, and a function
    /// that does takes twenty times as long; there the product is rounded, too, so that the last digits differ.
    fn fused(self, b: Self, c: Self) -> Self;
}

macro_rules! fused {
    ($($float:ty),*) => {
        $(impl Fused for $float {
            #[inline(always)]
            fn fused(self, b: Self, c: Self) -> Self {
                if cfg!(target_arch = "wasm32") { self * b + c } else { self.mul_add(b, c) }
            }
        })*
    };
}

fused!(f32, f64);
