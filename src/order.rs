//! Sorting by a key, in one place: every further instance of a generic sort costs kilobytes of WebAssembly.

/// Indices in increasing order of their keys, equal keys in increasing order of index.
pub fn order_by(keys: impl Iterator<Item = u64>) -> Vec<(u64, u32)> {
    let mut order: Vec<(u64, u32)> = keys.zip(0..).collect();
    order.sort_unstable();
    order
}

/// Indices in increasing order of their keys of N words, compared from the first word on; equal keys in increasing order of
/// index. N stable sorts by one word each, the last word first.
pub fn order_by_words<const N: usize>(keys: &[[u64; N]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..keys.len() as u32).collect();
    for word in (0..N).rev() {
        let sorted = order_by(order.iter().map(|&index| keys[index as usize][word]));
        order = sorted
            .iter()
            .map(|&(_, place)| order[place as usize])
            .collect();
    }
    order
}
