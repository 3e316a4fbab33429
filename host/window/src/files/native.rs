//! Whether the system has a file dialog. On Linux the dialog is a service on the session bus or a program. If both
//! are missing, the dialog library answers as if the user had cancelled, so this must be checked before.

#[cfg(target_os = "linux")]
use zbus::blocking::connection::Builder;

/// Whether a dialog would open.
#[cfg(not(target_os = "linux"))]
pub(super) fn is_there() -> bool {
    true
}

/// Whether a dialog would open: the desktop portal has a file chooser, or zenity is installed.
#[cfg(target_os = "linux")]
pub(super) fn is_there() -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    is_on_path("zenity", &path) || Builder::session().and_then(has_portal).unwrap_or(false)
}

#[cfg(target_os = "linux")]
fn is_on_path(program: &str, path: &std::ffi::OsStr) -> bool {
    std::env::split_paths(path).any(|folder| folder.join(program).is_file())
}

/// Asks the portal for its file chooser. A portal with no desktop behind it answers, but has none.
#[cfg(target_os = "linux")]
fn has_portal(bus: Builder<'_>) -> zbus::Result<bool> {
    /// A desktop that is just starting may answer late.
    const PATIENCE: std::time::Duration = std::time::Duration::from_secs(5);
    let bus = bus.method_timeout(PATIENCE).build()?;
    let portal = zbus::blocking::Proxy::new(
        &bus,
        "org.freedesktop.portal.Desktop",
        "/org/freedesktop/portal/desktop",
        "org.freedesktop.portal.FileChooser",
    )?;
    portal.get_property::<u32>("version").map(|_| true)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_found_in_the_folders_of_the_path_and_nowhere_else() {
        assert!(is_on_path("sh", "/nowhere:/bin".as_ref()));
        assert!(!is_on_path("sh", "/nowhere:".as_ref()));
        assert!(!is_on_path("no-such-program", "/bin:/usr/bin".as_ref()));
    }

    #[test]
    fn a_session_without_a_bus_has_no_portal() {
        assert!(has_portal(Builder::address("unix:path=/nonexistent/bus").unwrap()).is_err());
    }
}
