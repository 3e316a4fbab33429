//! The master level: hundredths of a decibel become an amplitude.

use micromath::F32Ext;
use slipline_protocol::units::{CentiDecibel, Gain};

/// `10^(level / 2000)` as Q1.31, for levels of at most 0; above 0 it is full scale.
///
/// Made as `2^(k + f)` with the whole part by shifting, so that only `2^f`, `f` in 0..1, is computed in floats and
/// every machine gets the same bits.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "the power lies in 1..=2")]
pub fn master_gain(level: CentiDecibel) -> Gain {
    if level.0 >= 0 {
        return Gain::FULL;
    }
    // log2(10) / 2000 octaves of amplitude per hundredth of a decibel.
    const OCTAVES: f32 = core::f32::consts::LOG2_10 / 2000.0;
    let octaves = f32::from(level.0) * OCTAVES;
    // By the trait's name: a plain `.floor()` would be the standard library's wherever that is linked.
    let whole = F32Ext::floor(octaves);
    let mantissa = F32Ext::exp(core::f32::consts::LN_2 * (octaves - whole)).clamp(1.0, 2.0);
    // -32768 hundredths are 54 octaves: beyond 31 nothing is left.
    let down = (-whole) as u32;
    // Q1.31 times 2^24 stays in 64 bits; f32 holds 24 bits, so nothing is lost.
    let gain = (u64::from((mantissa * 16_777_216.0) as u32) << 7).checked_shr(down).unwrap_or(0);
    Gain(gain.min(u64::from(Gain::FULL.0)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_attenuation_is_full_scale_exactly() {
        assert_eq!(master_gain(CentiDecibel(0)), Gain::FULL);
    }

    #[test]
    fn decibels_are_decibels_to_a_hundredth() {
        for cdb in (-9600..=0).step_by(7) {
            let got = f64::from(master_gain(CentiDecibel(cdb)).0) / f64::from(1u32 << 31);
            let want = 10f64.powf(f64::from(cdb) / 2000.0);
            let error_db = 20.0 * (got / want).log10();
            assert!(error_db.abs() < 0.02, "{cdb}: {got} for {want}, {error_db} dB off");
        }
    }

    #[test]
    fn a_quieter_master_is_never_louder() {
        let mut last = Gain::FULL;
        for cdb in (i16::MIN..=0).rev() {
            let gain = master_gain(CentiDecibel(cdb));
            assert!(gain <= last, "at {cdb}");
            last = gain;
        }
    }
}
