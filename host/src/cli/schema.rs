//! The schema of `--json`: `host/JSON.md` lists every field. A field that is renamed or gone, or has another unit, raises
//! [`SCHEMA`]; a new field does not.

use serde_json::{Value, json};

/// Version of the fields of `--json`.
pub const SCHEMA: u32 = 1;

/// The fields of an answer, and the names of the files that the command has written.
pub(super) fn with_files(mut answer: Value, files: Vec<String>) -> Value {
    // JSON `files`, text: Files that were written
    answer["files"] = json!(files);
    answer
}

/// A command's object with its schema, without negative zeros.
pub(super) fn finished(value: &Value) -> Value {
    let mut value = value.clone();
    if let Value::Object(fields) = &mut value {
        // JSON `schema`, count: Version of these fields
        fields.insert("schema".to_owned(), json!(SCHEMA));
    }
    lose_negative_zeros(&mut value);
    value
}

fn lose_negative_zeros(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() && number.as_f64() == Some(0.0) => *value = json!(0.0),
        Value::Array(values) => values.iter_mut().for_each(lose_negative_zeros),
        Value::Object(fields) => fields.values_mut().for_each(lose_negative_zeros),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign_and_an_object_its_schema() {
        let value = finished(&json!({ "a": [-0.0, 1.5], "b": { "c": -0.0 }, "d": 0 }));
        assert_eq!(value.to_string(), r#"{"a":[0.0,1.5],"b":{"c":0.0},"d":0,"schema":1}"#);
    }
}
