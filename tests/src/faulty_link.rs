//! A link with faults, seeded: the same seed makes the same faults.

/// How often each fault happens, as a share of the frames that pass (of the bits, for `flip`).
#[derive(Clone, Copy, Debug, Default)]
pub struct LinkFaults {
    /// A frame is lost.
    pub drop: f64,
    /// A frame comes twice.
    pub duplicate: f64,
    /// A frame is held back and comes after up to eight later ones.
    pub reorder: f64,
    /// A bit is flipped.
    pub flip: f64,
    /// A frame loses its end.
    pub truncate: f64,
    /// Some random bytes come before a frame.
    pub insert: f64,
    /// A frame comes in two pieces, the second after the next frame's time.
    pub split: f64,
    /// A frame comes late, in order.
    pub delay: f64,
    /// A frame is echoed to its sender.
    pub echo: f64,
}

/// How many later frames a held-back frame may be overtaken by.
const REORDER_WINDOW: u32 = 8;

/// xorshift64*: small, seeded, and good enough to decide on faults.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// From a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed ^ 0x9e37_79b9_7f4a_7c15)
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = if self.0 == 0 { 1 } else { self.0 };
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// 0..1.
    pub fn share(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// 0..`end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.bits() % end.max(1)
    }

    /// True with this probability.
    pub fn happens(&mut self, probability: f64) -> bool {
        self.share() < probability
    }
}

/// One direction of a link with faults. Frames go in at one end and bytes come out at the other, one call a frame time.
#[derive(Clone, Debug)]
pub struct FaultyLink {
    faults: LinkFaults,
    random: Random,
    /// Bytes on the way, each lot with the number of calls it still waits.
    held: Vec<(u32, Vec<u8>)>,
    echoed: Vec<u8>,
}

impl FaultyLink {
    /// A link with these faults.
    #[must_use]
    pub const fn new(seed: u64, faults: LinkFaults) -> Self {
        Self { faults, random: Random::new(seed), held: Vec::new(), echoed: Vec::new() }
    }

    /// Puts a frame in (or nothing) and takes out what arrives at the other end now.
    pub fn pass(&mut self, frame: &[u8]) -> Vec<u8> {
        let LinkFaults { drop, duplicate, reorder, flip, truncate, insert, split, delay, echo } = self.faults;
        let mut arrived = Vec::new();
        let mut still_held = Vec::new();
        for (wait, bytes) in self.held.drain(..) {
            if wait == 0 {
                arrived.extend(bytes);
            } else {
                still_held.push((wait - 1, bytes));
            }
        }
        self.held = still_held;
        if frame.is_empty() || self.random.happens(drop) {
            return arrived;
        }
        if self.random.happens(echo) {
            self.echoed.extend_from_slice(frame);
        }
        let mut bytes = frame.to_vec();
        if self.random.happens(truncate) {
            bytes.truncate(self.random.below(bytes.len() as u64) as usize);
        }
        if flip > 0.0 {
            for byte in &mut bytes {
                for bit in 0..8 {
                    if self.random.happens(flip) {
                        *byte ^= 1 << bit;
                    }
                }
            }
        }
        if self.random.happens(insert) {
            let noise: Vec<u8> = (0..1 + self.random.below(20)).map(|_| self.random.bits() as u8).collect();
            bytes.splice(0..0, noise);
        }
        let times = if self.random.happens(duplicate) { 2 } else { 1 };
        for _ in 0..times {
            if self.random.happens(reorder) {
                let wait = self.random.below(u64::from(REORDER_WINDOW)) as u32;
                self.held.push((wait, bytes.clone()));
            } else if self.random.happens(delay) {
                self.held.push((0, bytes.clone()));
            } else if self.random.happens(split) {
                let at = self.random.below(bytes.len() as u64 + 1) as usize;
                arrived.extend_from_slice(&bytes[..at]);
                self.held.push((0, bytes[at..].to_vec()));
            } else {
                arrived.extend_from_slice(&bytes);
            }
        }
        arrived
    }

    /// What came back to the sender since the last call.
    pub fn echoes(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.echoed)
    }
}
