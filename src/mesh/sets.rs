//! Disjoint sets of numbers.

/// Disjoint sets of the numbers below a length (Galler and Fischer 1964, with halved paths).
pub struct Sets(Vec<u32>);

impl Sets {
    /// Each number alone.
    pub fn new(len: usize) -> Sets {
        Sets((0..len as u32).collect())
    }

    /// The lowest number of a member's set.
    pub fn find(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            let parent = self.0[member as usize];
            self.0[member as usize] = self.0[parent as usize];
            member = self.0[member as usize];
        }
        member
    }

    /// Makes one set of the sets of two members.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
