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

/// The names of the two settings, of their variables, and what is built in.
const PORT: (&str, &str, &str) = ("port", "SLIPLINE_PORT", "sim");
const PLATE: (&str, &str, &str) = ("plate", "SLIPLINE_PLATE", "membrane");

/// Where a value is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    Option,
    Environment,
    SettingsFile,
    BuiltIn,
}

impl Origin {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Option => "option",
            Self::Environment => "environment",
            Self::SettingsFile => "settings file",
            Self::BuiltIn => "built-in",
        }
    }
}

/// A default and where it is from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chosen {
    pub(super) value: String,
    pub(super) from: Origin,
}

impl Chosen {
    pub(super) fn value(&self) -> Value {
        json!({ "value": self.value, "from": self.from.name() })
    }

    pub(super) fn words(&self) -> String {
        format!("{} ({})", self.value, self.from.name())
    }
}

/// The defaults of a run.
#[derive(Debug)]
pub(super) struct Defaults {
    pub(super) port: Chosen,
    pub(super) plate: Chosen,
    /// The settings file, whether or not it exists; `None` on a system without a folder for it.
    pub(super) file: Option<PathBuf>,
    /// Why a variable or the file is refused; then the built-in values stand.
    refused: Option<Failure>,
}

static DEFAULTS: OnceLock<Defaults> = OnceLock::new();

/// The defaults of this run.
pub(super) fn defaults() -> &'static Defaults {
    DEFAULTS.get_or_init(|| {
        let file = folder().map(|folder| folder.join("slipline").join("settings.toml"));
        let variables = [PORT, PLATE].map(|(_, name, _)| var(name).ok().filter(|text| !text.is_empty()));
        Defaults::of(variables, file)
    })
}

pub(super) fn port() -> &'static str {
    &defaults().port.value
}

pub(super) fn plate() -> &'static str {
    &defaults().plate.value
}

/// Refuses a variable or a settings file that cannot be used.
pub(super) fn check() -> Result<(), Failure> {
    defaults().refused.clone().map_or(Ok(()), Err)
}

impl Defaults {
    /// By the values of both variables and the file.
    fn of([port, plate]: [Option<String>; 2], file: Option<PathBuf>) -> Self {
        let named = |name: &str, text: String| match text.parse::<Port>() {
            Ok(_) => Ok(text),
            Err(error) => Err(Failure::Usage(format!("{name} = {text:?}: {error}"))),
        };
        let settings = file.as_deref().map_or(Ok([None, None]), read);
        let found = settings.and_then(|[set_port, set_plate]| {
            let in_file = |text| named(&format!("{}: port", shown(file.as_deref())), text);
            let set_port = set_port.map(in_file).transpose()?;
            let port = port.map(|text| named(PORT.1, text)).transpose()?;
            Ok([chosen(port, set_port, PORT.2), chosen(plate, set_plate, PLATE.2)])
        });
        let built_in = [chosen(None, None, PORT.2), chosen(None, None, PLATE.2)];
        let ([port, plate], refused) = found.map_or_else(|why| (built_in, Some(why)), |found| (found, None));
        Self { port, plate, file, refused }
    }
}

fn shown(file: Option<&Path>) -> String {
    file.map_or(String::new(), |file| file.display().to_string())
}

fn chosen(variable: Option<String>, setting: Option<String>, built_in: &str) -> Chosen {
    let variable = variable.map(|value| Chosen { value, from: Origin::Environment });
    let setting = setting.map(|value| Chosen { value, from: Origin::SettingsFile });
    variable.or(setting).unwrap_or_else(|| Chosen { value: built_in.to_owned(), from: Origin::BuiltIn })
}

/// Port and plate of a settings file; none of them if there is no file.
fn read(file: &Path) -> Result<[Option<String>; 2], Failure> {
    let refused = |message: String| Failure::Usage(format!("{}: {message}", file.display()));
    let text = match read_text(file, BYTES_MAX) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok([None, None]),
        text => text.map_err(|error| refused(said(&error)))?,
    };
    let fields: toml::Table =
        toml::from_str(&text).map_err(|error| refused(error.to_string().trim_end().to_owned()))?;
    let [mut port, mut plate] = [None, None];
    for (name, value) in fields {
        let toml::Value::String(text) = value else {
            return Err(refused(format!("{name} = {value}: write a text in quotes")));
        };
        match name.as_str() {
            "port" => port = Some(text),
            "plate" => plate = Some(text),
            _ => return Err(refused(format!("{name} is no setting: the settings are port and plate"))),
        }
    }
    Ok([port, plate])
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
