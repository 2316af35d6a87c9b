//! Edits of a text that leave everything else in it as it is.

use std::ops::Range;

use crate::order::order_by;

/// A text and what is to be replaced in it.
#[derive(Clone)]
pub(super) struct Splice<'t> {
    pub text: &'t str,
    edits: Vec<(Range<usize>, String)>,
}

impl<'t> Splice<'t> {
    pub fn new(text: &'t str) -> Self {
        Self {
            text,
            edits: Vec::new(),
        }
    }

    /// The text in a range.
    pub fn get(&self, range: Range<usize>) -> &'t str {
        self.text.get(range).unwrap_or_default()
    }

    /// Replaces a range, which overlaps no other that is replaced.
    pub fn replace(&mut self, range: Range<usize>, replacement: String) {
        self.edits.push((range, replacement));
    }

    /// The edited text.
    pub fn finish(self) -> String {
        let mut output = String::with_capacity(self.text.len());
        let mut position = 0;
        let order = order_by(self.edits.iter().map(|(range, _)| range.start as u64));
        for (range, replacement) in order
            .iter()
            .filter_map(|&(_, index)| self.edits.get(index as usize))
        {
            output.push_str(self.get(position..range.start));
            output.push_str(replacement);
            position = range.end;
        }
        output.push_str(self.get(position..self.text.len()));
        output
    }
}
