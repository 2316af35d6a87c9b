//! Edits of a text that leave everything else in it as it is.

use std::collections::BTreeMap;
use std::ops::Range;

/// A text and what is to be replaced in it.
pub(super) struct Splice<'t> {
    pub text: &'t str,
    /// By the start of a range, its end and what replaces it.
    edits: BTreeMap<usize, (usize, String)>,
}

impl<'t> Splice<'t> {
    pub fn new(text: &'t str) -> Self {
        Self {
            text,
            edits: BTreeMap::new(),
        }
    }

    /// The text in a range.
    pub fn get(&self, range: Range<usize>) -> &'t str {
        self.text.get(range).unwrap_or_default()
    }

    /// Replaces a range, which overlaps no other that is replaced.
    pub fn replace(&mut self, range: Range<usize>, replacement: String) {
        self.edits.insert(range.start, (range.end, replacement));
    }

    /// The edited text.
    pub fn finish(self) -> String {
        let mut output = String::with_capacity(self.text.len());
        let mut position = 0;
        for (start, (end, replacement)) in &self.edits {
            output.push_str(self.get(position..*start));
            output.push_str(replacement);
            position = *end;
        }
        output.push_str(self.get(position..self.text.len()));
        output
    }
}
