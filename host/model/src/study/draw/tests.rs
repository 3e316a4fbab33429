use super::*;

#[test]
fn the_generator_has_the_published_vectors() {
    // Random123, `kat_vectors`: philox4x64 10.
    assert_eq!(
        philox([0; 4], [0; 2]),
        [0x1655_4D9E_CA36_314C, 0xDB20_FE9D_672D_0FDC, 0xD7E7_72CE_E186_176B, 0x7E68_B68A_EC7B_A23B]
    );
    assert_eq!(
        philox([u64::MAX; 4], [u64::MAX; 2]),
        [0x87B0_92C3_013F_E90B, 0x438C_3C67_BE8D_0224, 0x9CC7_D7C6_9CD7_77B6, 0xA09C_AEBF_594F_0BA0]
    );
    // The digits of pi.
    let counter =
        [0x243F_6A88_85A3_08D3, 0x1319_8A2E_0370_7344, 0xA409_3822_299F_31D0, 0x082E_FA98_EC4E_6C89];
    assert_eq!(
        philox(counter, [0x4528_21E6_38D0_1377, 0xBE54_66CF_34E9_0C6C]),
        [0xA528_F454_03E6_1D95, 0x38C7_2DBD_566E_9788, 0xA5A1_610E_72FD_18B5, 0x57BD_43B5_E52B_7FE6]
    );
}

#[test]
fn the_hash_has_the_published_vectors() {
    let vectors =
        [("", 0xCBF2_9CE4_8422_2325), ("a", 0xAF63_DC4C_8601_EC8C), ("foobar", 0x8594_4171_F739_67E8)];
    for (text, hash) in vectors {
        assert_eq!(path_hash(text), hash, "{text}");
    }
}

/// The numbers of one field of the plates 0 to 9999, sorted.
fn sorted(seed: u64, path: &str, number: fn(Draw) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = (0..10_000).map(|i| number(Draw::of(seed, i, path_hash(path)))).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// The largest distance of the empirical distribution from `law`, times the root of the count.
fn kolmogorov_smirnov(sorted: &[f64], law: impl Fn(f64) -> f64) -> f64 {
    let count = sorted.len() as f64;
    let distance = |(i, &x): (usize, &f64)| {
        let below = law(x) - i as f64 / count;
        below.max((i + 1) as f64 / count - law(x))
    };
    sorted.iter().enumerate().map(distance).fold(0.0, f64::max) * count.sqrt()
}

/// The normal distribution function, by Simpson's rule from 0.
fn normal_law(x: f64) -> f64 {
    let steps = 200;
    let width = x / f64::from(steps);
    let density = |t: f64| (-0.5 * t * t).exp() / TAU.sqrt();
    let weight = |i: i32| if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    0.5 + width / 3.0 * (0..=steps).map(|i| weight(i) * density(f64::from(i) * width)).sum::<f64>()
}

#[test]
fn normal_numbers_are_normal_and_uniform_ones_uniform() {
    for seed in [7, u64::MAX] {
        for path in ["loss_factor", "model.wave_speed_m_per_s"] {
            let normal = sorted(seed, path, Draw::normal);
            let moment = |power: i32| normal.iter().map(|z| z.powi(power)).sum::<f64>() / 1e4;
            // Four standard errors of 10 000 numbers: 1, the root of 2, of 15 and of 96 over 100.
            for (power, expected, error) in
                [(1, 0.0, 0.01), (2, 1.0, 0.0142), (3, 0.0, 0.0388), (4, 3.0, 0.098)]
            {
                assert!((moment(power) - expected).abs() < 4.0 * error, "moment {power}: {}", moment(power));
            }
            // Above 1.63 one set of numbers in a hundred lies.
            assert!(kolmogorov_smirnov(&normal, normal_law) < 1.63);
            let uniform = sorted(seed, path, Draw::uniform);
            assert!(kolmogorov_smirnov(&uniform, |u| 0.5 * (u + 1.0)) < 1.63);
            assert!((-1.0..-0.999).contains(&uniform[0]) && (0.999..1.0).contains(&uniform[9999]));
        }
    }
}

#[test]
fn fields_plates_and_seeds_are_independent() {
    let numbers = |seed: u64, skip: u64, path: &str| -> Vec<f64> {
        (0..10_000).map(|i| Draw::of(seed, i + skip, path_hash(path)).normal()).collect()
    };
    let base = numbers(7, 0, "loss_factor");
    for other in
        [numbers(7, 0, "taper.rate_per_m"), numbers(7, 1, "loss_factor"), numbers(8, 0, "loss_factor")]
    {
        let correlation = base.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>() / 1e4;
        assert!(correlation.abs() < 0.04, "{correlation}");
    }
}

#[test]
fn the_extremes_are_finite() {
    assert_eq!(Draw([0, 0]).normal(), 0.0);
    let farthest = Draw([u64::MAX, 0]).normal();
    assert!((8.5..8.6).contains(&farthest), "{farthest}");
    assert_eq!((Draw([0, 0]).uniform(), Draw([u64::MAX, 0]).uniform()), (-1.0, 1.0 - f64::EPSILON));
}

#[test]
fn numpy_draws_the_same_numbers() {
    // numpy.random.Philox(key=[seed, 0], counter=[plate, hash, 0, 0] - 1).random_raw(2), and Python's math.
    let cases = [
        (
            7,
            0,
            "loss_factor",
            [0x5ED6_0D7F_160C_11A3, 0x58AB_43AC_59AF_D848],
            -0.259_092_629_381_398_9,
            -0.547_539_695_513_343_6,
        ),
        (
            7,
            3,
            "model.wave_speed_m_per_s",
            [0x6C8C_4EF5_41F1_DC08, 0x1AF2_E78B_58E8_DEFD],
            -0.151_968_126_530_946_93,
            0.828_893_711_351_604_1,
        ),
        (
            (1 << 63) - 1,
            999_999,
            "taper.rate_per_m",
            [0x993D_B701_40C8_1F67, 0xC24A_81E8_6D07_D965],
            0.197_195_888_149_111_15,
            0.075_935_599_736_660_06,
        ),
    ];
    for (seed, plate, path, raw, uniform, normal) in cases {
        let draw = Draw::of(seed, plate, path_hash(path));
        assert_eq!(draw, Draw(raw));
        assert_eq!(draw.uniform(), uniform);
        assert!((draw.normal() - normal).abs() < 1e-14, "{path}");
    }
}
