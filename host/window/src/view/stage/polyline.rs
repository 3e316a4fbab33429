//! Lines of many points, drawn with as few as the screen can show.

use eframe::egui::Pos2;

/// How far a drawn line may lie beside the given one, in points: less than what smooth edges show.
const TOLERANCE: f32 = 0.1;
/// Most points that one segment replaces; it bounds the time for a straight line.
const LONGEST: usize = 64;

/// Leaves out points that lie within [`TOLERANCE`] of the segment between their neighbours that stay. Each segment of
/// a line costs the graphics several triangles, and without a graphics card a triangle costs more than its area.
pub(crate) fn thinned(line: &[Pos2]) -> Vec<Pos2> {
    kept(line).into_iter().map(|number| line[number]).collect()
}

/// The numbers of the points that [`thinned`] keeps.
pub(crate) fn kept(line: &[Pos2]) -> Vec<usize> {
    let mut kept: Vec<usize> = (!line.is_empty()).then_some(0).into_iter().collect();
    let mut start = 0;
    while start + 1 < line.len() {
        let mut end = start + 1;
        while end + 1 < line.len() && end + 1 - start <= LONGEST && is_straight(&line[start..=end + 1]) {
            end += 1;
        }
        kept.push(end);
        start = end;
    }
    kept
}

/// Whether all points lie within the tolerance of the segment from the first to the last.
fn is_straight(points: &[Pos2]) -> bool {
    let (&[first, .., last], [_, inner @ ..]) = (points, points) else { return true };
    let along = last - first;
    let length = along.length().max(f32::MIN_POSITIVE);
    inner.iter().all(|&point| {
        let off = point - first;
        (along.x * off.y - along.y * off.x).abs() <= TOLERANCE * length
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn a_straight_line_keeps_few_points_and_a_curve_stays_in_place() {
        let line: Vec<Pos2> = (0..=300).map(|x| pos2(x as f32, 20.0)).collect();
        assert_eq!(thinned(&line).len(), 1 + 300_usize.div_ceil(LONGEST));
        let wave = |x: f32| 50.0 * (0.1 * x).sin();
        let line: Vec<Pos2> = (0..=600).map(|x| pos2(0.5 * x as f32, wave(0.5 * x as f32))).collect();
        let few = thinned(&line);
        assert!(few.len() < line.len() / 3, "{}", few.len());
        assert_eq!((few.first(), few.last()), (line.first(), line.last()));
        for point in &line {
            let next = few.partition_point(|kept| kept.x < point.x).max(1);
            let (a, b) = (few[next - 1], few[next]);
            let y = a.y + (b.y - a.y) * (point.x - a.x) / (b.x - a.x);
            let slope = (b.y - a.y) / (b.x - a.x);
            assert!((y - point.y).abs() <= 1.01 * TOLERANCE * slope.hypot(1.0), "{point:?}");
        }
    }

    #[test]
    fn few_points_stay_as_they_are() {
        assert!(thinned(&[]).is_empty());
        assert_eq!(thinned(&[pos2(1.0, 2.0)]), [pos2(1.0, 2.0)]);
        let corner = [pos2(0.0, 0.0), pos2(5.0, 0.0), pos2(5.0, 5.0)];
        assert_eq!(thinned(&corner), corner);
    }
}
