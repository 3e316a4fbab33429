//! Where the parts of a figure stand, and text broken into lines that fit.

/// Size of the finished picture, pixels.
pub(super) const SIZE: (u32, u32) = (1240, 500);
/// The picture is drawn this many times larger and averaged down: the canvas draws lines without smoothing.
pub(super) const OVERSAMPLING: u32 = 2;

/// Heights and text sizes, in pixels of the finished picture.
pub(super) mod pixels {
    /// Text size of the figure's title.
    pub(in crate::export::figures) const TITLE: u32 = 19;
    /// Text size of a panel's heading.
    pub(in crate::export::figures) const HEADING: u32 = 16;
    /// Text size of conventions, legend, labels.
    pub(in crate::export::figures) const TEXT: u32 = 14;
    /// Height of a line of that text.
    pub(in crate::export::figures) const LINE: u32 = 18;
    /// Room left and right of a panel.
    pub(in crate::export::figures) const MARGIN: u32 = 14;
    /// Height of the title's strip.
    pub(in crate::export::figures) const TITLE_STRIP: u32 = 32;
    /// Length of a legend's line sample.
    pub(in crate::export::figures) const SAMPLE: u32 = 24;
}

/// Breaks text into lines no wider than `width`, by the given measure; a word that is wider stands alone.
pub(super) fn wrapped(text: &str, width: u32, measure: impl Fn(&str) -> u32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if measure(&format!("{line} {word}")) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Places of items of the given widths in rows no wider than `width`: (left edge, row) each.
pub(super) fn rows(widths: &[u32], width: u32, gap: u32) -> Vec<(u32, u32)> {
    let (mut left, mut row) = (0, 0);
    widths
        .iter()
        .map(|&wide| {
            if left > 0 && left + wide > width {
                (left, row) = (0, row + 1);
            }
            let place = (left, row);
            left += wide + gap;
            place
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_broken_between_words_and_loses_none() {
        let measure = |text: &str| text.chars().count() as u32;
        let text = "a plate that narrows carries a wave";
        let lines = wrapped(text, 12, measure);
        assert!(lines.len() > 2 && lines.iter().all(|line| measure(line) <= 12), "{lines:?}");
        assert_eq!(lines.join(" "), text);
        assert_eq!(wrapped("unbreakable", 3, measure), ["unbreakable"]);
        assert!(wrapped("", 3, measure).is_empty());
    }

    #[test]
    fn items_go_on_to_the_next_row_when_one_is_full() {
        assert_eq!(rows(&[40, 40, 40], 100, 10), [(0, 0), (50, 0), (0, 1)]);
        assert_eq!(rows(&[200, 20], 100, 10), [(0, 0), (0, 1)]);
    }
}
