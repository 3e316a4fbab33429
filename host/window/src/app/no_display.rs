//! Why no window opens, and what helps, as a message to the user.

/// The variables that name a display on Linux and BSD.
const DISPLAYS: [&str; 2] = ["WAYLAND_DISPLAY", "DISPLAY"];

/// The message for an error of the window system.
#[expect(clippy::wildcard_enum_match_arm, reason = "eframe's errors depend on its features")]
pub(super) fn explain(error: &eframe::Error) -> String {
    let reason = match error {
        // The text of the inner error, without the type name that the outer error puts in front.
        eframe::Error::Winit(error) => error.to_string(),
        eframe::Error::WinitEventLoop(error) => error.to_string(),
        eframe::Error::AppCreation(error) => error.to_string(),
        error => error.to_string(),
    };
    let reason = without_source_place(&reason);
    let has_named_displays = cfg!(all(unix, not(target_os = "macos")));
    if !(has_named_displays && matches!(error, eframe::Error::WinitEventLoop(_))) {
        return format!("the window could not be opened: {reason}");
    }
    let set: Vec<String> = DISPLAYS
        .iter()
        .filter_map(|name| Some((name, std::env::var(name).ok().filter(|value| !value.is_empty())?)))
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let what = if set.is_empty() {
        "there is no display to open a window on: neither WAYLAND_DISPLAY nor DISPLAY is set".to_owned()
    } else {
        format!("the display {} does not answer: {reason}", set.join(", "))
    };
    format!(
        "{what}.\nStart slipline in a desktop session, or set WAYLAND_DISPLAY or DISPLAY to its display \
         (over ssh: ssh -X).\nThe command line needs no display: see slipline --help."
    )
}

/// The reason without the source file and line that the window library puts in front: they name a folder of the
/// machine that built the program.
fn without_source_place(text: &str) -> String {
    let place = text.find("os error at ").and_then(|start| {
        let file = start + text.get(start..)?.find(".rs:")?;
        let end = file + text.get(file..)?.find(": ")?;
        Some((start, end + 2))
    });
    let text = match place {
        Some((start, end)) => format!("{}{}", &text[..start], &text[end..]),
        None => text.to_owned(),
    };
    text.trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::without_source_place;

    #[test]
    fn a_reason_is_kept_without_the_place_in_the_source() {
        for (text, wanted) in [
            ("os error at /home/a b/registry/winit/mod.rs:765: nothing is set.", "nothing is set"),
            ("OS: os error at C:\\winit\\mod.rs:7: it: failed", "OS: it: failed"),
            ("os error at a place nobody knows", "os error at a place nobody knows"),
            ("no such thing: at all", "no such thing: at all"),
        ] {
            assert_eq!(without_source_place(text), wanted);
        }
    }
}
