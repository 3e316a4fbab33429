//! `slipline design`.

use super::argument::{self, Typed};
use super::design_argument::{band, loss, margin, material, name, speed, tension};
use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::schema::with_files;
use super::{output, progress};
use clap::{ArgGroup, Args, ValueEnum};
use serde_json::json;
use slipline_model::answer::design::{DesignAnswer, design};
use slipline_plate::check::Colour;
use slipline_plate::design::{Design, Edge, Material, Request, Wave, end_margin_range, start_margin_range};
use slipline_plate::limits;
use slipline_plate::quantity::number_format::{significant, with_decimals};
use slipline_plate::quantity::{Measure, Range, show_frequency, show_length, show_si};
use slipline_plate::{Air, AirMounting, Faces, Gas};
use std::io::Write;
use std::path::{Path, PathBuf};

/// `design`.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("wave").args(["edge", "wave_speed", "tension", "shear"]))]
pub struct DesignArguments {
    /// The sheet: aluminium, steel, stainless-steel, brass, glass, fr4, acrylic, polycarbonate, polyester-film,
    /// silicone-rubber or latex.
    #[arg(long, value_name = "M", value_parser = material)]
    material: Material,
    /// The sheet's thickness, such as 2mm; 1um to 100mm.
    #[arg(long, value_name = "T", value_parser = argument::length(limits::THICKNESS), allow_hyphen_values = true)]
    thickness: f64,
    /// The lowest and the highest frequency of the tones, such as 20kHz..40kHz; 0.5Hz to 10MHz.
    #[arg(long, value_name = "F..F", value_parser = band, allow_hyphen_values = true)]
    band: (f64, f64),
    /// From the driven end to the narrow end, such as 300mm; 5mm to 10m.
    #[arg(long, value_name = "L", value_parser = argument::length(limits::LENGTH), allow_hyphen_values = true)]
    length: f64,
    /// A plate in bending: how its edges are held, on a lip that may turn (the default) or tight between the frames.
    #[arg(long)]
    edge: Option<EdgeArgument>,
    /// A stretched membrane of this wave speed, such as 12m/s; 0.1 to 20000.
    #[arg(long, value_name = "C", value_parser = speed(), allow_hyphen_values = true)]
    wave_speed: Option<f64>,
    /// A membrane stretched with this tension, such as 70N/m.
    #[arg(long, value_name = "N", value_parser = tension, allow_hyphen_values = true)]
    tension: Option<Typed<f64>>,
    /// The shear-horizontal wave of the paper.
    #[arg(long)]
    shear: bool,
    /// The air around the plate: on both faces and around the edges of a bare frame (the default), behind a
    /// wide rigid wall, or none.
    #[arg(long, conflicts_with = "shear")]
    air: Option<AirArgument>,
    /// Leave out shear and rotary inertia of a bending plate.
    #[arg(long)]
    thin: bool,
    /// From the driven end to the nearest turning point; by default, as much as its peak needs.
    #[arg(long, value_name = "X", value_parser = margin, allow_hyphen_values = true)]
    start_margin: Option<Typed<f64>>,
    /// From the farthest turning point to the narrow end; by default, as much as its tail needs.
    #[arg(long, value_name = "X", value_parser = margin, allow_hyphen_values = true)]
    end_margin: Option<Typed<f64>>,
    /// Loss factor, 0 to 0.5; by default, the material's.
    #[arg(long, value_name = "ETA", value_parser = loss(), allow_hyphen_values = true)]
    loss: Option<f64>,
    /// The drive's displacement at DAC full scale, 1nm to 100mm; by default, 1um from 1 kHz on, else 100um.
    #[arg(long, value_name = "A", value_parser = argument::length(limits::FULL_SCALE), allow_hyphen_values = true)]
    full_scale: Option<f64>,
    /// Width of the frame's rim, 10mm to 500mm.
    #[arg(long, value_name = "X", value_parser = argument::length(limits::RIM), allow_hyphen_values = true, default_value = "20mm")]
    rim: f64,
    /// The plate's name, 1 to 80 characters.
    #[arg(long, value_parser = name, default_value = "designed")]
    name: String,
    /// Write plate.toml and the cut files of plate and frame (SVG, DXF) into this folder; they contain the
    /// mounting instructions.
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// The air around the plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum AirArgument {
    BareFrame,
    Baffle,
    Vacuum,
}

impl AirArgument {
    /// The air of a room.
    const fn air(self) -> Air {
        match self {
            Self::BareFrame => Air::ROOM,
            Self::Baffle => Air::Around {
                gas: Gas::ROOM,
                mounting: AirMounting::Baffle { faces: Faces::Two },
                gap_m: None,
            },
            Self::Vacuum => Air::Vacuum,
        }
    }
}

/// How the edges of a bending plate are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EdgeArgument {
    // The variants have no help text, which would double the length of the help.
    Supported,
    Clamped,
}

impl DesignArguments {
    fn request(&self) -> Result<Request, Failure> {
        let mut material = self.material.clone();
        if let Some(loss) = self.loss {
            material.loss_factor = loss;
        }
        let tensions = Wave::tensions(&material, self.thickness);
        let within = |option: &str, typed: &Option<Typed<f64>>, range: Range, measure: Measure| {
            typed.as_ref().map(|typed| typed.within(option, range, measure, "")).transpose()
        };
        let tension = within("--tension", &self.tension, tensions, Measure::Plain("N/m"))?;
        let wave = match (self.wave_speed, tension, self.shear) {
            (Some(wave_speed_m_per_s), _, _) => Wave::Membrane { wave_speed_m_per_s },
            (None, Some(tension), _) => Wave::under_tension(tension, &material, self.thickness),
            (None, None, true) => Wave::ShearHorizontal,
            (None, None, false) => Wave::Bending {
                edge: match self.edge {
                    Some(EdgeArgument::Clamped) => Edge::Clamped,
                    Some(EdgeArgument::Supported) | None => Edge::Supported,
                },
                thick_plate: !self.thin,
            },
        };
        let mut request = Request::new(&self.name, material, self.thickness, wave, self.band, self.length);
        let (nearest, farthest) = (start_margin_range(self.length), end_margin_range(self.length));
        request.start_margin_m = within("--start-margin", &self.start_margin, nearest, Measure::Length)?;
        request.end_margin_m = within("--end-margin", &self.end_margin, farthest, Measure::Length)?;
        request.rim_m = self.rim;
        if let Some(air) = self.air {
            request.air = Some(air.air());
        }
        if let Some(full_scale_m) = self.full_scale {
            request.full_scale_m = full_scale_m;
        }
        Ok(request)
    }
}

pub(super) fn run(arguments: &DesignArguments, as_json: bool) -> Result<(), Failure> {
    let request = arguments.request()?;
    let folder = arguments.out.as_deref();
    let free = folder
        .map(|folder| Destination::folder(folder, &FILES, arguments.force))
        .transpose()?
        .unwrap_or_default();
    let (designed, lights) =
        progress::watched("design", |progress| design(&request, progress)).map_err(Failure::refused)?;
    let files = write_files(&designed, &free)?;
    let value = with_files(json!(DesignAnswer::of(&designed, &lights)), Destination::names(&free));
    output::print(as_json, &value, |out| {
        // The summary is written as comments, so that the output is a valid plate file.
        for (name, text) in summary(&designed) {
            writeln!(out, "# {name:<21} {text}")?;
        }
        match &lights {
            Ok(report) => {
                for light in report.lights.iter().filter(|light| light.colour > Colour::Green) {
                    writeln!(out, "# {}: {}", light.colour.name(), light.sentence)?;
                }
            }
            // The lights say what the caution does.
            Err(reason) => {
                if let Some(caution) = designed.caution() {
                    writeln!(out, "# caution: {caution}")?;
                }
                writeln!(out, "# not checked: {reason}")?;
            }
        }
        for file in &files {
            writeln!(out, "# written: {}", file.display())?;
        }
        if files.is_empty() {
            write!(out, "{}", designed.plate.to_toml())?;
        }
        Ok(())
    })
}

fn summary(designed: &Design) -> Vec<(&'static str, String)> {
    let plate = &designed.plate;
    let damper = designed.damper;
    let mut lines = vec![
        (
            "taper",
            format!(
                "full width {} at the driven end, {} at the narrow end, d = {} /m",
                show_si(2.0 * plate.cut_half_width_m(0.0), "m"),
                show_si(2.0 * plate.cut_half_width_m(plate.length_m()), "m"),
                with_decimals(designed.rate_per_m, 3)
            ),
        ),
        ("lowest turning point", band_end(&designed.low)),
        ("highest turning point", band_end(&designed.high)),
        (
            "loss",
            format!(
                "loss factor {}; the peak is the largest amplitude up to {}",
                significant(plate.spec().loss_factor, 4),
                with_decimals(designed.loss_factor_limit, 4)
            ),
        ),
        (
            "single turning point",
            format!(
                "up to {} with the drive on the centre line ({} of travel), up to {} beside it",
                show_si(designed.single_boundary_to_m, "m"),
                show_si(designed.mode_free_travel_m(), "m"),
                show_si(designed.single_boundary_off_centre_to_m, "m")
            ),
        ),
    ];
    let resistance = show_si(damper.resistance_n_s_per_m, "N s/m");
    match damper.lead_in {
        Some(lead_in) => lines.push((
            "lead-in",
            format!(
                "{} behind the drive with a loss factor of {}, R = {resistance} at its far end",
                show_si(lead_in.length_m, "m"),
                significant(lead_in.loss_factor, 4)
            ),
        )),
        None => lines.push((
            "damper",
            format!(
                "R = {resistance} matches at {}; r = {:.2} to {:.2} over the band",
                show_frequency(damper.match_frequency_hz),
                damper.ratio_range.0,
                damper.ratio_range.1
            ),
        )),
    }
    let back = 100.0 * damper.largest_reflection;
    lines.push(("match", format!("at most {back:.0} % of the returning wave comes back")));
    if let Some(tension) = designed.tension_n_per_m {
        lines.push(("tension", format!("{} of width", show_si(tension, "N/m"))));
    }
    lines.push(("mounting", designed.mounting.sentence().to_owned()));
    lines.extend(designed.frame.map(|frame| {
        let over = frame.over_threshold_db.map_or_else(String::new, |db| {
            format!(
                ", {} dB {} what a finger feels",
                with_decimals(db.abs(), 0),
                if db < 0.0 { "below" } else { "over" }
            )
        });
        let text = format!(
            "two sheets of {} of {}, {}: first bending at {}{over}",
            show_length(frame.sheet_m),
            frame.material,
            show_si(1e3 * frame.mass_kg, "g"),
            show_frequency(frame.first_bending_hz)
        );
        ("frame", text)
    }));
    lines
}

fn band_end(end: &slipline_plate::design::BandEnd) -> String {
    format!(
        "{} at {}, edge width {}, {} wavelengths",
        show_frequency(end.frequency_hz),
        show_si(end.boundary_m, "m"),
        show_si(end.edge_width_m, "m"),
        with_decimals(end.wavelengths, 2)
    )
}

/// The files that are written into the folder.
const FILES: [&str; 5] = ["plate.toml", "plate.svg", "plate.dxf", "frame.svg", "frame.dxf"];

/// Writes the plate file and the cut files, each to its destination; returns their paths.
fn write_files<'a>(designed: &Design, free: &'a [Destination]) -> Result<Vec<&'a Path>, Failure> {
    let (plate, frame) = (designed.plate_drawing(), designed.frame_drawing());
    // In the order of the names above.
    let texts = [designed.plate.to_toml(), plate.to_svg(), plate.to_dxf(), frame.to_svg(), frame.to_dxf()];
    free.iter()
        .zip(texts)
        .map(|(file, text)| {
            file.write(|out| Ok(out.write_all(text.as_bytes())?))?;
            Ok(file.path())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Alone {
        #[command(flatten)]
        arguments: DesignArguments,
    }

    fn parsed(line: &str) -> Result<DesignArguments, String> {
        let words = std::iter::once("design").chain(line.split_whitespace());
        Alone::try_parse_from(words).map(|alone| alone.arguments).map_err(|error| error.to_string())
    }

    const ALUMINIUM: &str = "--material aluminium --thickness 2mm --band 20kHz..40kHz --length 300mm";

    #[test]
    fn quantities_carry_their_units_into_the_request() {
        let request = parsed(ALUMINIUM).expect("parses").request().expect("known");
        assert_eq!((request.thickness_m, request.band_hz, request.length_m), (2e-3, (20e3, 40e3), 0.3));
        assert_eq!(request.wave, Wave::Bending { edge: Edge::Supported, thick_plate: true });
        assert_eq!((request.rim_m, request.full_scale_m), (0.02, 1e-6));

        let membrane =
            "--material latex --thickness 0.5mm --band 80Hz..220Hz --length 40cm --tension 68.4N/m";
        let request = parsed(membrane).expect("parses").request().expect("known");
        // 68.4 N/m over 950 kg/m^3 x 0.5 mm is (12 m/s)^2.
        let Wave::Membrane { wave_speed_m_per_s } = request.wave else { panic!("{:?}", request.wave) };
        assert!((wave_speed_m_per_s - 12.0).abs() < 1e-9, "{wave_speed_m_per_s}");
    }

    #[test]
    fn a_wave_is_named_once_and_a_bad_band_is_explained() {
        assert!(parsed(&format!("{ALUMINIUM} --edge clamped --shear")).expect_err("both").contains("cannot"));
        let error = parsed(&ALUMINIUM.replace("20kHz..40kHz", "20kHz")).expect_err("no band");
        assert!(error.contains("20kHz..40kHz"), "{error}");
        let error = parsed(&ALUMINIUM.replace("aluminium", "aluminum")).expect_err("unknown");
        assert!(
            error.contains("'--material <M>'") && error.contains("did you mean \"aluminium\"?"),
            "{error}"
        );
    }

    #[test]
    fn the_files_are_written_and_the_plate_file_can_be_read_back() {
        let folder = std::env::temp_dir().join(format!("slipline-design-{}", std::process::id()));
        let mut arguments = parsed(ALUMINIUM).expect("parses");
        arguments.out = Some(folder.clone());
        run(&arguments, true).expect("done");
        let text = std::fs::read_to_string(folder.join("plate.toml")).expect("there");
        let plate = slipline_plate::Plate::from_toml(&text).expect("a plate");
        assert!((plate.band_hz().0 - 20e3).abs() < 1e-2 && (plate.band_hz().1 - 40e3).abs() < 1e-2);
        for name in ["plate.svg", "plate.dxf", "frame.svg", "frame.dxf"] {
            assert!(std::fs::metadata(folder.join(name)).expect(name).len() > 500, "{name}");
        }
        std::fs::remove_dir_all(&folder).expect("removable");
    }
}
