//! docs/c2pa.json: what the schema of C2PA's list of soft bindings asks of an entry, as far as an entry can be held to it before it has a number.

use crate::portable_test;
use serde_json::Value;

#[portable_test]
fn c2pa_entry_has_what_the_list_asks_for() {
    let entry: Value = serde_json::from_str(include_str!("../../docs/c2pa.json")).unwrap();
    assert!(
        entry["identifier"]
            .as_u64()
            .is_some_and(|number| number < 1 << 16)
    );
    assert_eq!(entry["type"], "watermark");
    assert_eq!(entry["decodedMediaTypes"][0], "model");
    let labels: Vec<&str> = entry["alg"].as_str().unwrap().split('.').collect();
    let is_label =
        |label: &&str| !label.is_empty() && label.chars().all(|c| c.is_ascii_alphanumeric());
    assert!(
        labels.len() > 2 && labels.iter().all(is_label),
        "{labels:?}"
    );
    for field in ["description", "dateEntered", "contact", "informationalUrl"] {
        assert!(entry["entryMetadata"][field].is_string(), "{field}");
    }
}
