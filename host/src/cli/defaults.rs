//! Defaults of `--port` and `--plate`: the environment, the settings file, what is built in.
//!
//! ```text
//! option -> environment -> settings file -> built-in      the first that exists
//! ```
//! The settings file is `settings.toml` in the platform's folder for the configuration of programs.

use super::failure::Failure;
use serde_json::{Value, json};
use slipline_link::Port;
use slipline_model::atomic_file::{read_text, said};
use std::env::{home_dir, var, var_os};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Longest settings file, bytes.
const BYTES_MAX: usize = 1 << 16;

/// Most characters of a line that a refusal repeats.
const QUOTED: usize = 60;
/// How settings are written.
const SETTINGS: &str = "port = \"NAME\" or plate = \"NAME\", with the quotation marks";

/// The names of the two settings, of their variables, and what is built in.
const PORT: (&str, &str, &str) = ("port", "SLIPLINE_PORT", "sim");
const PLATE: (&str, &str, &str) = ("plate", "SLIPLINE_PLATE", "membrane");

/// A default and where it is from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chosen {
    pub(super) value: String,
    pub(super) from: &'static str,
}

impl Chosen {
    pub(super) fn value(&self) -> Value {
        // JSON `value` of info, text: The default; its entry is null where the setting is refused
        // JSON `from` of info, text: option, environment, settings file or built-in
        json!({ "value": self.value, "from": self.from })
    }

    pub(super) fn words(&self) -> String {
        format!("{} ({})", self.value, self.from)
    }
}

/// The defaults of a run; each is refused only where it is needed.
#[derive(Debug)]
pub(super) struct Defaults {
    pub(super) port: Result<Chosen, Failure>,
    pub(super) plate: Result<Chosen, Failure>,
    /// The settings file, whether or not it exists; `None` on a system without a folder for it.
    pub(super) file: Option<PathBuf>,
}

static DEFAULTS: OnceLock<Defaults> = OnceLock::new();

/// The defaults of this run.
pub(super) fn defaults() -> &'static Defaults {
    DEFAULTS.get_or_init(|| {
        let file = folder().map(|folder| folder.join("slipline").join("settings.toml"));
        let settings = file.as_deref().map_or(Ok(toml::Table::new()), read);
        let port = chosen(PORT, &settings, file.as_deref(), |text| {
            text.parse::<Port>().map(drop).map_err(|error| error.to_string())
        });
        let plate = chosen(PLATE, &settings, file.as_deref(), |_| Ok(()));
        Defaults { port, plate, file }
    })
}

/// The port of a command that names none.
pub(super) fn port() -> Result<Port, Failure> {
    defaults().port.clone()?.value.parse().map_err(Failure::usage)
}

/// The plate of a command that names none.
pub(super) fn plate() -> Result<&'static str, Failure> {
    defaults().plate.as_ref().map(|plate| plate.value.as_str()).map_err(Clone::clone)
}

/// The default of a setting: of its variable, of the file, or what is built in. What comes before the file does not need it.
fn chosen(
    (name, variable, built_in): (&str, &str, &str),
    settings: &Result<toml::Table, Failure>,
    file: Option<&Path>,
    check: impl Fn(&str) -> Result<(), String>,
) -> Result<Chosen, Failure> {
    let usable = |value: String, place: &str, from| match check(&value) {
        Ok(()) => Ok(Chosen { value, from }),
        Err(why) => Err(Failure::Usage(format!("{place} = {value:?}: {why}"))),
    };
    if let Some(value) = var(variable).ok().filter(|text| !text.is_empty()) {
        return usable(value, variable, "environment");
    }
    let place = format!("{}: {name}", file.map_or(String::new(), |file| file.display().to_string()));
    match settings.as_ref().map_err(Clone::clone)?.get(name) {
        None => Ok(Chosen { value: built_in.to_owned(), from: "built-in" }),
        Some(toml::Value::String(text)) => usable(text.clone(), &place, "settings file"),
        Some(value) => Err(Failure::Usage(format!("{place} = {value}: write a text in quotes"))),
    }
}

/// The settings of a file; none if there is no file.
fn read(file: &Path) -> Result<toml::Table, Failure> {
    let refused = |message: String| Failure::Usage(format!("{}: {message}", file.display()));
    let text = match read_text(file, BYTES_MAX) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(toml::Table::new()),
        text => text.map_err(|error| refused(said(&error)))?,
    };
    let settings: toml::Table = toml::from_str(&text).map_err(|error| {
        let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
        let number = before.matches('\n').count() + 1;
        let line: String = text.lines().nth(number - 1).unwrap_or_default().chars().take(QUOTED).collect();
        refused(format!("line {number}: '{}' is no setting: write {SETTINGS}", line.trim()))
    })?;
    match settings.keys().find(|name| ![PORT.0, PLATE.0].contains(&name.as_str())) {
        Some(name) => Err(refused(format!("{name} is no setting: the settings are port and plate"))),
        None => Ok(settings),
    }
}

/// The platform's folder for the configuration of programs.
fn folder() -> Option<PathBuf> {
    let absolute = |name| var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    if cfg!(windows) {
        absolute("APPDATA")
    } else if cfg!(target_os = "macos") {
        home_dir().map(|home| home.join("Library").join("Application Support"))
    } else {
        absolute("XDG_CONFIG_HOME").or_else(|| home_dir().map(|home| home.join(".config")))
    }
}
