//! `slipline presets`.

use super::failure::Failure;
use super::output;
use serde_json::json;

pub(super) fn run(as_json: bool) -> Result<(), Failure> {
    let presets = slipline_plate::presets();
    let list: Vec<_> = presets
        .iter()
        // JSON `description`, text: Description of the preset
        .map(|preset| json!({ "name": preset.name, "description": preset.description() }))
        .collect();
    output::print(as_json, &json!({ "presets": list }), |out| {
        let lines: Vec<_> = presets.iter().map(|preset| (preset.name, preset.description())).collect();
        output::lines(out, &lines)
    })
}
