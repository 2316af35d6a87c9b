//! Sorting by a key, in one place: every further instance of a generic sort costs kilobytes of WebAssembly.

/// Indices in increasing order of their keys, equal keys in increasing order of index.
pub fn order_by(keys: impl Iterator<Item = u64>) -> Vec<(u64, u32)> {
    let mut order: Vec<(u64, u32)> = keys.zip(0..).collect();
    order.sort_unstable();
    order
}
