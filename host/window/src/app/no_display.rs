//! Why no window opens, and what helps, as a message to the user.

/// The variables that name a display on Linux and BSD.
const DISPLAYS: [&str; 2] = ["WAYLAND_DISPLAY", "DISPLAY"];

/// How eframe begins its error where the system offers no OpenGL; a list of what was asked for follows, which helps nobody.
const NO_OPENGL: &str = "Found no glutin configs";

/// What is lacking for a window on the X server that winit will use, before winit panics about it: a library, or the extension
/// RANDR. Nothing where there is no such server, which winit reports itself.
pub(super) fn lacking() -> Option<String> {
    #[cfg(all(unix, not(target_vendor = "apple")))]
    {
        use x11rb::connection::RequestConnection as _;
        if set("WAYLAND_DISPLAY").or(set("WAYLAND_SOCKET")).is_some() {
            return None;
        }
        let (connection, _) = x11rb::connect(Some(&set("DISPLAY")?)).ok()?;
        if let Some(lacking) = super::libraries::lacking() {
            return Some(lacking);
        }
        matches!(connection.extension_information("RANDR"), Ok(None)).then(|| {
            "the X server of this display has no extension RANDR, which the window needs: start the server with it, or use \
             another display. Without it, \"slipline page\" shows the same window in a browser"
                .to_owned()
        })
    }
    #[cfg(not(all(unix, not(target_vendor = "apple"))))]
    None
}

/// The value of a variable of the environment; an empty one is none.
fn set(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

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
    if reason.starts_with(NO_OPENGL) {
        let cause = reason.rsplit_once("Error: ").map_or("", |(_, cause)| cause);
        return format!(
            "the window could not be opened: this display offers no OpenGL ({cause}).\nInstall its driver (on Debian and Ubuntu: \
             libgl1 libegl1 libgl1-mesa-dri), over ssh use ssh -Y, or run \"slipline page\", which shows the same window in a \
             browser.\nThe command line needs no display: see slipline --help."
        );
    }
    let has_named_displays = cfg!(all(unix, not(target_os = "macos")));
    if !(has_named_displays && matches!(error, eframe::Error::WinitEventLoop(_))) {
        return format!("the window could not be opened: {reason}");
    }
    let named: Vec<String> =
        DISPLAYS.iter().filter_map(|name| Some(format!("{name}={}", set(name)?))).collect();
    let what = if named.is_empty() {
        "there is no display to open a window on: neither WAYLAND_DISPLAY nor DISPLAY is set".to_owned()
    } else {
        format!("the display {} does not answer: {reason}", named.join(", "))
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
    use super::{explain, without_source_place};

    #[test]
    fn a_display_without_opengl_is_called_so_with_what_helps() {
        let reason = "Found no glutin configs matching the template: ConfigTemplate { alpha_size: 8 }. Error: initialization failed";
        let message = explain(&eframe::Error::AppCreation(reason.into()));
        assert!(message.contains("offers no OpenGL (initialization failed)"), "{message}");
        assert!(message.contains("libgl1-mesa-dri") && message.contains("slipline page"), "{message}");
        assert!(!message.contains("ConfigTemplate"), "{message}");
    }

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
