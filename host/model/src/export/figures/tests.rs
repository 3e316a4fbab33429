use super::font::FAMILIES;
use super::page::{BLACK, HUES, Page, Pen};
use super::painting::parsed;
use super::*;
use resvg::usvg::{Group, Node, Text, Tree, roxmltree};
use slipline_plate::paper::figures;
use slipline_plate::{Equation, respond};

/// Every text of a drawing.
fn texts<'a>(group: &'a Group, found: &mut Vec<&'a Text>) {
    for node in group.children() {
        match node {
            Node::Text(text) => found.push(text),
            Node::Group(inner) => texts(inner, found),
            Node::Path(_) | Node::Image(_) => {}
        }
    }
}

/// Checks every figure's common properties: it is well-formed XML with text left as text in the stated font,
/// every letter has its glyph, and no text leaves the page or is compressed. Returns the texts.
pub(super) fn look_over(drawing: &Drawing) -> Vec<String> {
    let document = roxmltree::Document::parse(drawing.svg()).expect("well-formed");
    let root = document.root_element();
    assert_eq!((root.tag_name().name(), root.attribute("font-family")), ("svg", Some(FAMILIES)));
    assert!(root.attribute("width").expect("a size").ends_with("pt"));
    let written: Vec<&str> = document
        .descendants()
        .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")))
        .filter_map(|node| node.text())
        .collect();
    let tree: Tree = parsed(drawing.svg()).expect("readable");
    let mut found = Vec::new();
    texts(tree.root(), &mut found);
    assert_eq!(found.len(), written.len(), "every text is drawn");
    let (width, height) = (tree.size().width(), tree.size().height());
    for (text, written) in found.iter().zip(&written) {
        let glyphs = || text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
        assert!(
            glyphs().count() > 0 && glyphs().all(|glyph| glyph.id.0 != 0),
            "a glyph is missing: {written}"
        );
        let place = text.abs_bounding_box();
        let is_inside =
            place.left() >= 0.0 && place.top() >= 0.0 && place.right() <= width && place.bottom() <= height;
        assert!(is_inside, "{written:?} leaves the page of {width} x {height}: {place:?}");
    }
    written.into_iter().map(str::to_owned).collect()
}

/// Width, height and pixels of a PNG file, and its dots per metre.
pub(super) fn decoded(file: &[u8]) -> (u32, u32, Vec<[u8; 3]>, Option<u32>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG file");
    let mut data = vec![0; reader.output_buffer_size().expect("small")];
    let info = reader.next_frame(&mut data).expect("a picture");
    let dots = reader.info().pixel_dims.map(|dims| dims.xppu);
    assert_eq!(info.color_type, png::ColorType::Rgb);
    let pixels = data[..info.buffer_size()].chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width, info.height, pixels, dots)
}

#[test]
fn both_panels_hold_their_curves_and_the_file_is_small() {
    for figure in figures().expect("computed") {
        let drawing = paper_figure(&figure);
        let labels = look_over(&drawing);
        for name in [figure.x_label, figure.panels[0].y_label, figure.panels[1].y_label, "as printed"] {
            assert!(labels.iter().any(|text| text == name), "{}: {name}", figure.stem);
        }
        let file = drawing.file(Format::Png).expect("painted");
        assert!(file.len() < 100_000, "{}: {}", figure.stem, file.len());
        assert!(drawing.svg().len() < 100_000, "{}: {}", figure.stem, drawing.svg().len());
        let (width, height, pixels, _) = decoded(&file);
        assert_eq!((width, height), (1240, 500));
        let blue = |from: u32, to: u32| {
            let near = |p: &[u8; 3]| p[0] < 40 && (85..150).contains(&p[1]) && p[2] > 140;
            (0..pixels.len() as u32)
                .filter(|i| (from..to).contains(&(i % width)) && near(&pixels[*i as usize]))
                .count()
        };
        assert!(blue(0, width / 2) > 300 && blue(width / 2, width) > 300, "{}", figure.stem);
    }
}

#[test]
fn a_response_shows_its_peak_at_print_size() {
    let plate = slipline_plate::preset("membrane").expect("there");
    let frequency_hz = plate.frequency_for_boundary_hz(0.18);
    let response = respond(&plate, frequency_hz, 200_001, Equation::Corrected).expect("it enters");
    let drawing = response_figure(&response, plate.name());
    let labels = look_over(&drawing);
    assert!(labels.iter().any(|text| text.contains("turning point 180.0 mm")), "{labels:?}");
    assert!(labels.iter().any(|text| text.starts_with("peak ")), "{labels:?}");
    assert!(drawing.svg().len() < 100_000, "as many points as can be seen: {}", drawing.svg().len());
    let (width, _, _, dots) = decoded(&drawing.file(Format::Png).expect("painted"));
    assert!((f64::from(width) / f64::from(dots.expect("a size")) - 0.170).abs() < 2e-4);
}

#[test]
fn text_is_painted_and_lines_are_cut_at_the_frame() {
    let empty = Page::new((72.0, 36.0), "empty").finish(144.0);
    let mut page = Page::new((72.0, 36.0), "wave");
    page.text("W", (36.0, 18.0), page::Anchor::Centre, 12.0, BLACK);
    let corners = [(0.0, 0.0), (36.0, 0.0), (36.0, 36.0), (0.0, 36.0)];
    page.clipped(corners, |page| page.line([(0.0, 30.0), (72.0, 30.0)], Pen::solid(HUES[0], 2.0)));
    let drawing = page.finish(144.0);
    let dark = |drawing: &Drawing, from: u32, to: u32, rows: std::ops::Range<u32>| {
        let (width, height, pixels, dots) = decoded(&drawing.file(Format::Png).expect("painted"));
        assert_eq!((width, height, dots), (144, 72, Some(5669)));
        let places = rows.flat_map(|y| (from..to).map(move |x| (y * width + x) as usize));
        places.filter(|&i| pixels[i][0] < 100).count()
    };
    assert_eq!(dark(&empty, 0, 144, 0..72), 0);
    assert!(dark(&drawing, 54, 90, 20..52) > 30, "the letter");
    assert_eq!(dark(&drawing, 0, 72, 56..64), 72 * 4, "the line, 2 points thick");
    assert_eq!(dark(&drawing, 73, 144, 56..64), 0, "cut off");
}

#[test]
fn any_name_of_a_plate_is_a_title() {
    for name in ["a < b & \"c\" > 'd'", "κ ≤ 1 – ½ µm", "]]>", "two\nlines\u{0}\u{ffff}", "", "a  b"] {
        let mut page = Page::new((400.0, 40.0), name);
        page.text(name, (10.0, 20.0), page::Anchor::Left, 8.0, BLACK);
        let drawing = page.finish(72.0);
        let document = roxmltree::Document::parse(drawing.svg()).expect("well-formed");
        let shown: String = name
            .chars()
            .map(|letter| if matches!(letter, '\n' | '\0' | '\u{ffff}') { '\u{fffd}' } else { letter })
            .collect();
        for element in ["title", "text"] {
            let found = document.descendants().find(|node| node.tag_name().name() == element).expect("there");
            assert_eq!(found.text().unwrap_or_default(), shown);
        }
        drawing.file(Format::Png).expect("painted");
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let figure = &figures().expect("computed")[1];
    for &format in Format::ALL {
        let file = || paper_figure(figure).file(format).expect("drawn");
        assert!(file() == file(), "{format:?}");
    }
}

#[test]
fn pixels_are_read_back_with_their_opacity() {
    let see_through = [[10, 20, 30, 40], [0, 0, 0, 0], [255, 1, 2, 255], [9, 8, 7, 6]];
    let file = encode((2, 2), &see_through, None).expect("encoded");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().expect("a PNG file");
    let mut data = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut data).expect("a picture");
    assert_eq!(data, see_through.as_flattened());
    let opaque = see_through.map(|[red, green, blue, _]| [red, green, blue, 255]);
    let (width, height, pixels, dots) = decoded(&encode((2, 2), &opaque, Some(300.0)).expect("encoded"));
    assert_eq!((width, height, dots), (2, 2, Some(11811)));
    assert_eq!(pixels[3], [9, 8, 7]);
    assert!(encode((0, 0), &[], None).is_err() && encode((2, 2), &opaque[..3], None).is_err());
}

/// A picture without its numbers, and its numbers.
fn parted(svg: &str) -> (String, Vec<f64>) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let (mut text, mut number, mut numbers) = (String::new(), String::new(), Vec::new());
    for c in svg.chars().chain(['\n']) {
        if is_number(c) {
            number.push(c);
            continue;
        }
        if !number.is_empty() {
            match number.parse() {
                Ok(value) => numbers.push(value),
                Err(_) => text.push_str(&number),
            }
            number.clear();
        }
        text.push(c);
    }
    (text, numbers)
}

#[test]
fn the_pictures_of_the_physics_page_are_those_that_the_command_draws() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../plate/figures");
    for figure in slipline_plate::physics::figures().expect("computed") {
        let drawing = paper_figure(&figure);
        look_over(&drawing);
        let path = folder.join(format!("{}.svg", figure.stem));
        if std::env::var_os("SLIPLINE_BLESS").is_some() {
            std::fs::write(&path, drawing.svg()).expect("written");
        }
        let stored = std::fs::read_to_string(&path).expect("a stored picture");
        let ((wanted, places), (found, stored)) = (parted(drawing.svg()), parted(&stored));
        let redo = "make it again: slipline figures --out host/plate/figures --force";
        assert!(wanted == found && places.len() == stored.len(), "{} is stale, {redo}", figure.stem);
        // A twentieth of a point: processors round differently.
        let apart = places.iter().zip(&stored).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.05, "{} is {apart} points off, {redo}", figure.stem);
    }
}
