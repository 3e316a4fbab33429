//! Writes a figure as CSV: comment lines with the conventions, then one row per point.

use super::figure::Figure;
use std::fmt::Write;

impl Figure {
    /// The figure as CSV with the columns `panel, curve, x, y`; the header has the unit of x, a comment line the
    /// meaning of y. A mark is a row without y. Lines that begin with `#` are comments with the conventions. Texts are
    /// in quotation marks, because some have commas.
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "# {}", self.heading());
        for panel in &self.panels {
            for line in panel.convention {
                let _ = writeln!(text, "# {}: {line}", panel.heading);
            }
            let _ = writeln!(text, "# {}: y is {}", panel.heading, panel.y_label);
        }
        let _ = writeln!(text, "panel,curve,{},y", quoted(self.x_label));
        for panel in &self.panels {
            for series in &panel.series {
                for (x, y) in &series.points {
                    let _ = writeln!(text, "{},{},{x},{y:e}", quoted(panel.heading), quoted(&series.name));
                }
            }
            for mark in &panel.marks {
                let _ = writeln!(text, "{},{},{},", quoted(panel.heading), quoted(&mark.name), mark.x);
            }
        }
        text
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use crate::paper::figures;

    #[test]
    fn a_csv_holds_every_point_and_every_mark_of_both_panels() {
        for figure in figures().expect("the presets show them") {
            let csv = figure.to_csv();
            let rows: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).skip(1).collect();
            let expected: usize = figure
                .panels
                .iter()
                .map(|panel| {
                    panel.marks.len() + panel.series.iter().map(|series| series.points.len()).sum::<usize>()
                })
                .sum();
            assert_eq!(rows.len(), expected, "{}", figure.stem);
            // Four cells in every row, the head included: a comma within quotation marks separates none.
            let cells = |row: &str| {
                row.split('"').step_by(2).map(|outside| outside.matches(',').count()).sum::<usize>()
            };
            let table = csv.lines().filter(|line| !line.starts_with('#'));
            table.for_each(|row| assert_eq!(cells(row), 3, "{}: {row}", figure.stem));
            let series = &figure.panels[1].series[0];
            let (x, y) = series.points[7];
            let row = rows
                .iter()
                .filter(|row| row.starts_with(&format!("\"corrected\",\"{}\",", series.name)))
                .nth(7)
                .expect("the eighth point");
            let mut numbers = row.rsplit(',').map(|number| number.parse::<f64>().expect("a number"));
            assert_eq!((numbers.next().expect("y"), numbers.next().expect("x")), (y, x), "all digits");
        }
    }
}
