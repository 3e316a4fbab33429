use crate::calibrate::{File, Foreign, SensorKind};
use num_complex::Complex64;
use proptest::prelude::*;

/// Three points, at uneven frequencies and at even ones.
const UNEVEN: [f64; 9] = [100.0, 0.5, -0.25, 101.5, 0.125, 2.0, 104.0, -1.0, 0.75];

/// A universal file of these bytes, with `kind` as the first line of the dataset.
fn bytes(kind: &str, form: u32, is_even: bool, data: &[u8]) -> Vec<u8> {
    let even = u32::from(is_even);
    let head = format!(
        "    -1\n    58b{kind}\nshaker\nNONE\nNONE\nNONE\nNONE\n    4 0 0 0 NONE 1 3 NONE 0 0\n{form:>10}         3{even:>10}  \
         1.00000E+02  2.00000E+00  0.00000E+00\n        18    0    0    0 Frequency Hz\n        12    0    0    0 Acc NONE\n\
         0 0 0 0 NONE NONE\n         0 0 0 0 NONE NONE\n"
    );
    [head.as_bytes(), data, b"    -1\n"].concat()
}

fn read(bytes: &[u8]) -> Foreign {
    match File::read(bytes, &[]) {
        Ok(File::Foreign(foreign)) => foreign,
        other => panic!("{other:?}"),
    }
}

/// The numbers of the three points as bytes of a precision and an order.
fn data(is_even: bool, double: (bool, bool), is_little: bool) -> Vec<u8> {
    let (abscissa, ordinates) = double;
    let one = |value: f64, is_double: bool| match (is_double, is_little) {
        (true, true) => value.to_le_bytes().to_vec(),
        (true, false) => value.to_be_bytes().to_vec(),
        (false, true) => (value as f32).to_le_bytes().to_vec(),
        (false, false) => (value as f32).to_be_bytes().to_vec(),
    };
    let row = |row: &[f64]| {
        let frequency = if is_even { Vec::new() } else { one(row[0], abscissa) };
        [frequency, one(row[1], ordinates), one(row[2], ordinates)].concat()
    };
    UNEVEN.chunks_exact(3).flat_map(row).collect()
}

#[test]
fn bytes_of_both_orders_and_precisions_are_the_numbers_of_the_text() {
    for is_little in [true, false] {
        for (form, double) in [(5, (false, false)), (6, (true, true)), (6, (false, true))] {
            for is_even in [false, true] {
                let data = data(is_even, double, is_little);
                let order = if is_little { 1 } else { 2 };
                let kind = format!(
                    "     {order}     2          11{:>12}     0     0           0           0",
                    data.len()
                );
                let found = read(&bytes(&kind, form, is_even, &data));
                assert_eq!(found.sensor, Some(SensorKind::Acceleration));
                let wanted: Vec<(f64, Complex64)> = UNEVEN
                    .chunks_exact(3)
                    .zip([100.0, 102.0, 104.0])
                    .map(|(row, even)| (if is_even { even } else { row[0] }, Complex64::new(row[1], -row[2])))
                    .collect();
                let pairs: Vec<_> =
                    found.points.iter().map(|it| (it.frequency_hz, it.response.expect("a number"))).collect();
                assert_eq!(pairs, wanted, "{form} {double:?} {is_even} {is_little}");
            }
        }
    }
}

#[test]
fn what_is_wrong_with_a_binary_file_is_named() {
    let data = data(false, (false, false), true);
    let size = data.len();
    let refused = |bytes: &[u8]| File::read(bytes, &[]).unwrap_err().to_string();
    for (kind, wanted) in [
        (
            format!(" 3 2 11 {size} 0 0 0 0"),
            "line 2: dataset 58b: the order of the bytes = 3: must be 1 (the lowest first) or 2",
        ),
        (
            format!(" 1 3 11 {size} 0 0 0 0"),
            "line 2: dataset 58b: the form of the numbers = 3: must be 2: IEEE 754",
        ),
        (format!(" 1 2 12 {size} 0 0 0 0"), "line 2: dataset 58b: the number of lines = 12: must be 11"),
        (" 1 2 11 999999 0 0 0 0".to_owned(), "line 2: dataset 58b: the file ends before the 999999 bytes"),
        (
            " 1 2 11 32 0 0 0 0".to_owned(),
            "line 2: dataset 58b: the 32 bytes of a dataset of 3 points: must be 12 for each point",
        ),
        (
            " 1 2 11 many 0 0 0 0".to_owned(),
            "line 2: dataset 58b: the number of bytes = many: must be a whole number",
        ),
        (" 1".to_owned(), "line 2: dataset 58b: the form of the numbers = nothing"),
    ] {
        let message = refused(&bytes(&kind, 5, false, &data));
        assert!(message.starts_with(wanted), "{kind}: {message}");
    }
    let good = format!(" 1 2 11 {size} 0 0 0 0");
    let mut bad = data.clone();
    bad[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = refused(&bytes(&good, 5, false, &bad));
    assert!(message.contains("number 2 of the dataset's bytes = NaN"), "{message}");
    let one = bytes(&good, 5, false, &data);
    let message = refused(&[&one[..], &one[..]].concat());
    assert!(message.contains("more than one function"), "{message}");
    assert!(refused(&one[..60]).contains("head is cut off"));
}

proptest! {
    #[test]
    fn no_bytes_behind_a_head_make_the_reader_panic(
        data in prop::collection::vec(any::<u8>(), 0..80),
        stated in 0_usize..100,
        form in 0_u32..8,
        order in 0_u32..4,
        is_even: bool,
    ) {
        let _ = File::read(&bytes(&format!(" {order} 2 11 {stated} 0 0 0 0"), form, is_even, &data), &[]);
    }
}
