//! Figures: SVG or PNG by the file's extension.

use super::{failure, file, json, refused, slipline};
use resvg::usvg::roxmltree;

/// The texts of a figure, and whether it is well-formed.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|node| node.tag_name().name() == "text");
    texts.filter_map(|node| node.text()).map(str::to_owned).collect()
}

#[test]
fn every_figure_of_the_paper_and_of_the_physics_is_written_as_vectors_as_a_picture_and_as_numbers() {
    let folder = file("paper");
    let out = folder.to_str().unwrap();
    let written = json(&["figures", "--out", out]);
    let written = written["figures"].as_array().unwrap();
    assert_eq!(written.len(), 11);
    let read = |path: &serde_json::Value| std::fs::read(path.as_str().unwrap()).unwrap();
    for figure in written {
        let title = figure["title"].as_str().unwrap();
        let of_paper = figure["number"].is_u64();
        let name = if of_paper { format!("Fig. {}", figure["number"]) } else { title.to_owned() };
        let csv = String::from_utf8(read(&figure["csv"])).unwrap();
        assert!(csv.starts_with(&format!("# {name}")), "{csv:.40}");
        assert!(read(&figure["png"]).starts_with(b"\x89PNG"));
        let labels = texts(&String::from_utf8(read(&figure["svg"])).unwrap());
        assert!(labels[0].starts_with(&name), "{labels:?}");
        assert_eq!(labels.iter().any(|text| text == "corrected"), of_paper, "{labels:?}");
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 33);
    std::fs::remove_dir_all(&folder).unwrap();

    let in_the_way = file("no-folder");
    std::fs::write(&in_the_way, "mine").unwrap();
    refused(&["figures", "--out", in_the_way.join("figures").to_str().unwrap()], 1, &["no-folder"]);
    std::fs::remove_file(in_the_way).unwrap();
}

#[test]
fn the_ending_says_what_is_written_and_others_are_refused_before_the_work() {
    let simulate = ["simulate", "--plate", "membrane", "--turning-point", "120mm", "--out"];
    let respond = ["respond", "--plate", "membrane", "--freq", "126Hz", "--out"];
    for (name, command) in [("envelope", &simulate[..]), ("response", &respond[..])] {
        let (svg, png, pdf) = (format!("{name}.svg"), format!("{name}.PNG"), format!("{name}.pdf"));
        let write = |name: &str| {
            let path = file(name);
            let output = slipline(&[command, &[path.to_str().unwrap()]].concat());
            assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
            let bytes = std::fs::read(&path).unwrap();
            std::fs::remove_file(path).unwrap();
            bytes
        };
        let labels = texts(&String::from_utf8(write(&svg)).unwrap());
        assert!(labels[0].contains("membrane"), "{labels:?}");
        assert!(labels.iter().any(|text| text == "x from the driven end (mm)"), "{labels:?}");
        assert!(write(&png).starts_with(b"\x89PNG"));
        let path = file(&pdf);
        refused(&[command, &[path.to_str().unwrap()]].concat(), 2, &["--out <FILE>", ".svg or .png"]);
        assert!(!path.exists());
    }
    // The first name of the option still works, and two kinds of output never share one file.
    let path = file("both.svg");
    let path = path.to_str().unwrap();
    let both = [&simulate[..5], &["--png", path, "--csv", path]].concat();
    assert!(failure(&both, 2).contains("--csv and --figure name the same file"));
}
