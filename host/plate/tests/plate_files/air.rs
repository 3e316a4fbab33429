//! The air of a plate file.

use super::*;

#[test]
fn air_is_read_written_and_refused_by_field_and_range() {
    let good =
        GOOD.replace("wave_speed_m_per_s = 12.0\n", "wave_speed_m_per_s = 12.0\ntension_n_per_m = 40\n");
    let with = |fields: &str| Plate::from_toml(&format!("{good}[air]\n{fields}"));
    for (fields, kilograms, carries) in [
        ("mounting = \"bare-frame\"\n", 1.204, true),
        ("mounting = \"unknown\"\ntemperature_c = 20.0\n", 1.204, true),
        ("mounting = \"calibrated\"\ncoefficient = 1.5\ndistant_share = 0.3\nfaces = 2\n", 1.204, true),
        ("mounting = \"baffle\"\nfaces = 1\ntemperature_c = 0\nheight_m = 1500\n", 1.079, true),
        ("mounting = \"coefficient\"\ncoefficient = 1.4\nfaces = 2\n", 1.204, true),
        ("mounting = \"baffle\"\ndensity_kg_per_m3 = 1.1\nsound_speed_m_per_s = 340\n", 1.1, true),
        ("mounting = \"vacuum\"\n", 0.0, false),
    ] {
        let plate = with(fields).expect(fields);
        assert_eq!(plate.carries_air(), carries, "{fields}");
        assert_eq!(Plate::from_toml(&plate.to_toml()).expect("its own text"), plate, "{fields}");
        if let Some(slipline_plate::Air::Around { gas, .. }) = plate.spec().air {
            assert!((gas.density_kg_per_m3() - kilograms).abs() < 1e-3, "{}", gas.density_kg_per_m3());
        }
    }
    for (fields, wanted) in [
        (
            "",
            "air.mounting is missing: the air that swings with the plate, one of \"baffle\", \"bare-frame\"",
        ),
        ("mounting = \"bafle\"\n", "air.mounting = \"bafle\": must be one of"),
        ("mounting = \"closed-box\"\n", "a closed box is a spring against the volume that the plate moves"),
        (
            "mounting = \"vacuum\"\nfaces = 2\n",
            "air.faces does not belong here: \"vacuum\" has no other field",
        ),
        (
            "mounting = \"bare-frame\"\nfaces = 1\n",
            "air.faces does not belong here: \"bare-frame\" has gap_m, density",
        ),
        ("mounting = \"baffle\"\nfaces = 3\n", "air.faces = 3: must be 1 or 2"),
        (
            "mounting = \"calibrated\"\ncoefficient = 1.5\ndistant_share = 3\n",
            "air.distant_share = 3: must be -1 to 2",
        ),
        ("mounting = \"coefficient\"\n", "air.coefficient is missing: \"coefficient\" needs it"),
        ("mounting = \"coefficient\"\ncoefficient = 11\n", "air.coefficient = 11: must be 0 to 10"),
        ("mounting = \"baffle\"\ntemperature_c = 200\n", "air.temperature_c = 200: must be -60 to 100 °C"),
        ("mounting = \"baffle\"\nheight_m = 1e5\n", "air.height_m = 100000: must be -500 to 9000 m"),
        ("mounting = \"baffle\"\ndensity_kg_per_m3 = 1.2\n", "air.sound_speed_m_per_s is missing"),
        (
            "mounting = \"baffle\"\ndensity_kg_per_m3 = 0\nsound_speed_m_per_s = 340\n",
            "air.density_kg_per_m3 = 0: must be 0.05 to 20 kg/m^3",
        ),
        (
            "mounting = \"baffle\"\ndensity_kg_per_m3 = 1.2\nsound_speed_m_per_s = 340\nheight_m = 9\n",
            "air.height_m does not belong here: the air is given by density_kg_per_m3 and sound_speed_m_per_s already",
        ),
        ("mounting = \"baffle\"\nface = 2\n", "did you mean faces?"),
    ] {
        let found = with(fields).expect_err(fields).to_string();
        assert!(found.contains(wanted), "{fields}: {found}");
    }
    // Air needs the plate's mass, and a wave that moves across its plane.
    let error = Plate::from_toml(&format!("{GOOD}[air]\nmounting = \"baffle\"\n")).expect_err("no mass");
    assert!(error.to_string().contains("model.tension_n_per_m is missing: [air] needs it"), "{error}");
    let shear = preset("al-sh").expect("a preset").to_toml();
    let error = Plate::from_toml(&format!("{shear}\n[air]\nmounting = \"baffle\"\n")).expect_err("shear");
    assert!(error.to_string().contains("air does not belong here: a shear-horizontal wave"), "{error}");
    assert!(Plate::from_toml(&format!("{shear}\n[air]\nmounting = \"vacuum\"\n")).is_ok());
}
