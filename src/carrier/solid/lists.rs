//! Lists of several lengths, one after the other in one piece of memory.

/// Lists of several lengths, one after the other.
#[derive(Default)]
pub struct Lists<T> {
    ends: Vec<usize>,
    pub items: Vec<T>,
}

impl<T> Lists<T> {
    pub fn get(&self, list: usize) -> &[T] {
        let start = if list == 0 { 0 } else { self.ends[list - 1] };
        &self.items[start..self.ends[list]]
    }

    pub fn end_list(&mut self) {
        self.ends.push(self.items.len());
    }
}

impl<T: Copy + Default> Lists<T> {
    /// From pairs of (list, item), visited twice.
    pub fn from_pairs<I: Iterator<Item = (u32, T)>>(
        num_lists: usize,
        pairs: impl Fn() -> I,
    ) -> Lists<T> {
        let mut ends = vec![0; num_lists];
        pairs().for_each(|(list, _)| ends[list as usize] += 1);
        let mut total = 0;
        for end in &mut ends {
            (*end, total) = (total, total + *end);
        }
        let mut items = vec![T::default(); total];
        for (list, item) in pairs() {
            let end = &mut ends[list as usize];
            items[*end] = item;
            *end += 1;
        }
        Lists { ends, items }
    }
}
