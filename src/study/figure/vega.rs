//! The Vega-Lite specification of a figure.

use super::Figure;
use serde_json::{Value, json};

/// A self-contained specification (data inline).
pub fn vega(figure: &Figure) -> Value {
    json!({ "$schema": "https://vega.github.io/schema/vega-lite/v6.json", "title": figure.title })
}
