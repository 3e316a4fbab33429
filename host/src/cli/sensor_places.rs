//! `slipline calibrate --plan`: proposed sensor places before a measurement.

use super::failure::Failure;
use super::output;
use serde_json::{Value, json};
use slipline_plate::Plate;
use slipline_plate::calibrate::{NearLimit, PairReach, PlaceWarning, Placing, SensorPlaces};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{show_length, show_place};

/// Prints the proposed places, the accuracy of pairs of places, and that of the pair `asked` for.
pub(super) fn print(
    plate: &Plate,
    placing: &Placing,
    asked: Option<[f64; 2]>,
    as_json: bool,
) -> Result<(), Failure> {
    let places = SensorPlaces::of(plate, placing).map_err(Failure::refused)?;
    let asked = asked.map(|places_m| Asked::of(&places, places_m)).transpose()?;
    output::print(as_json, &value(plate, &places, asked.as_ref()), |writer| {
        output::lines(writer, &lines(plate, &places, asked.as_ref()))?;
        writeln!(writer)?;
        output::table(writer, &table(&places))
    })
}

/// A requested pair of places.
struct Asked {
    reach: Option<PairReach>,
    warnings: Vec<PlaceWarning>,
}

impl Asked {
    fn of(places: &SensorPlaces, places_m: [f64; 2]) -> Result<Self, Failure> {
        let mut warnings = Vec::new();
        for place_m in places_m {
            warnings.extend(places.warning(place_m).map_err(Failure::refused)?);
        }
        Ok(Self { reach: places.reach(places_m), warnings })
    }
}

fn of_pair(pair: &PairReach) -> Value {
    json!({
        // JSON: Places of the sensor
        "places_m": pair.places_m,
        "turning_point_tolerance_m": pair.boundary_tolerance_m,
        "level_tolerance_db": pair.level_tolerance_db,
        // JSON: Uncertainty of the nodes at the driven end, 95 %
        "node_tolerance_m": pair.node_tolerance_m,
    })
}

fn value(plate: &Plate, places: &SensorPlaces, asked: Option<&Asked>) -> Value {
    json!({
        "plate": plate.name(),
        // JSON: Nearest place of a sensor
        "nearest_place_m": places.nearest_m,
        // JSON, text: Limit of the nearest place
        "nearest_by": limit(places.limit),
        "best": of_pair(&places.best),
        "pairs": places.pairs.iter().map(of_pair).collect::<Vec<_>>(),
        "sensor_masses": places.both_bear(),
        "caution": places.caution(),
        "check": places.check().map(|check| json!({
            "place_m": check.place_m,
            "turning_point_tolerance_m": check.boundary_tolerance_m,
            // JSON: Distance of turning points by both pairs from which on a check refuses
            "refuses_m": check.refuses_m,
        })),
        "asked": asked.map(|asked| json!({
            "pair": asked.reach.as_ref().map(of_pair),
            "warnings": asked.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })),
    })
}

fn limit(limit: NearLimit) -> String {
    match limit {
        NearLimit::NearField => "the near field".to_owned(),
        NearLimit::WidthMode(mode) => format!("width mode {mode}"),
    }
}

fn lines<'a>(plate: &Plate, places: &SensorPlaces, asked: Option<&Asked>) -> Vec<(&'a str, String)> {
    let [near, far] = places.best.places_m.map(show_place);
    let nearest = format!(
        "{} from the driven end; nearer, a sensor sees {} beside the wave",
        show_place(places.nearest_m),
        limit(places.limit)
    );
    let mut lines = vec![
        ("Plate", plate.name().to_owned()),
        ("Sensor at", format!("{near} and {far}")),
        ("Would reach", reach(&places.best)),
        ("Nearest place", nearest),
    ];
    lines.extend(places.check().map(|check| ("Check", check.to_string())));
    lines.extend(places.mass_note().map(|note| ("Mass", note)));
    lines.extend(places.caution().map(|caution| ("Caution", caution)));
    if let Some(asked) = asked {
        let there = asked.reach.as_ref();
        let reaches =
            there.map_or_else(|| "none: the two places do not determine the plate".to_owned(), reach);
        lines.push(("Requested places", reaches));
        lines.extend(asked.warnings.iter().map(|warning| ("Warning", warning.to_string())));
    }
    lines
}

fn reach(pair: &PairReach) -> String {
    format!(
        "turning points to {}, the level to {} dB, nodes at the driven end to {} (95 %, noise 40 dB below the signals)",
        show_length(pair.boundary_tolerance_m),
        with_decimals(pair.level_tolerance_db, 2),
        show_length(pair.node_tolerance_m)
    )
}

/// The best second place for each first one.
fn table(places: &SensorPlaces) -> Vec<Vec<String>> {
    let mut rows =
        vec![["First place", "Second place", "Turning point", "Level", "Nodes"].map(str::to_owned).to_vec()];
    rows.extend(places.best_of_each_first().map(|pair| {
        let [near, far] = pair.places_m.map(show_place);
        let level = format!("{} dB", with_decimals(pair.level_tolerance_db, 2));
        vec![near, far, show_length(pair.boundary_tolerance_m), level, show_length(pair.node_tolerance_m)]
    }));
    rows
}
