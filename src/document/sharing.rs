//! Which bytes serve what, and so which vertices can be moved without damage to other data.
//!
//! A position is fixed if any of its bytes also belongs to something that is not a vertex position
//! of the same number format: an accessor with another use (normals, indices, morph targets,
//! animations, or no known use), an image, or a buffer view that only an extension can be using.
//! Positions of two accessors may be the same bytes; then they are one position, and moving it
//! through one accessor moves it in the other. Positions that overlap in part are fixed.

use super::DocumentError;
use super::accessor::{Accessor, Format};
use super::region::{Region, Slot, View};
use super::schema::Root;
use crate::order::order_by_words;

/// The most comparisons of a position with a use of bytes about it, all position accessors together: some seconds. A scene of 2^24
/// vertices that are interleaved with seven attributes makes 2^27.
const MAX_COMPARISONS: u64 = 1 << 29;

/// The uses of the bytes of a document.
pub(super) struct Sharing {
    /// Whether each accessor holds the positions of some primitive.
    is_position: Vec<bool>,
    /// By storage and first byte.
    uses: Vec<Use>,
    /// A tree over the uses: the root is 1, the children of `n` are `2 n` and `2 n + 1`, the leaves are the uses in their order.
    /// Each node has the largest storage and end of the uses below it.
    reach: Vec<(usize, usize)>,
}

struct Use {
    region: Region,
    /// The number format of positions, `None` for every other use.
    format: Option<Format>,
}

impl Sharing {
    pub fn new(root: &Root, accessors: &[Accessor], views: &[View]) -> Result<Self, DocumentError> {
        let mut is_position = vec![false; accessors.len()];
        let mut has_other_use = vec![false; accessors.len()];
        for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
            for (name, &accessor) in &primitive.attributes {
                let uses = if name == "POSITION" {
                    &mut is_position
                } else {
                    &mut has_other_use
                };
                mark(uses, accessor);
            }
            let targets = primitive.targets.iter().flat_map(|target| target.values());
            targets
                .chain(&primitive.indices)
                .for_each(|&accessor| mark(&mut has_other_use, accessor));
        }
        for sampler in root
            .animations
            .iter()
            .flat_map(|animation| &animation.samplers)
        {
            mark(&mut has_other_use, sampler.input);
            mark(&mut has_other_use, sampler.output);
        }
        for &accessor in root.nodes.iter().flat_map(|node| node.instances.values()) {
            mark(&mut has_other_use, accessor);
        }

        let mut uses: Vec<(Region, Option<Format>)> = Vec::new();
        for (accessor, (is_position, has_other_use)) in
            accessors.iter().zip(is_position.iter().zip(has_other_use))
        {
            if *is_position {
                uses.extend(
                    accessor
                        .regions()
                        .map(|region| (region.clone(), Some(accessor.format))),
                );
            }
            if has_other_use || !is_position {
                uses.extend(accessor.regions().map(|region| (region.clone(), None)));
            }
            uses.extend(accessor.index_region().map(|region| (region.clone(), None)));
        }
        uses.extend(
            whole_views(root, views)
                .into_iter()
                .map(|region| (region, None)),
        );
        let uses = sorted(uses);
        let sharing = Self {
            is_position,
            reach: reach(&uses),
            uses,
        };
        sharing.check(accessors)?;
        Ok(sharing)
    }

    /// Refuses what [`fixed`](Self::fixed) would take too long for.
    fn check(&self, accessors: &[Accessor]) -> Result<(), DocumentError> {
        let mut comparisons: u64 = 0;
        for accessor in accessors
            .iter()
            .filter(|accessor| self.is_position(accessor.index))
        {
            let near: usize = accessor
                .regions()
                .map(|region| self.near(region).len())
                .fold(0, usize::saturating_add);
            // One more for finding them, so that empty accessors count.
            let each = (accessor.count as u64).saturating_add(1);
            comparisons = comparisons.saturating_add(each.saturating_mul(near as u64));
            if comparisons > MAX_COMPARISONS {
                return Err(DocumentError::TooLarge {
                    what: "the number of vertices, times the other accessors that reach into their bytes,",
                    value: comparisons,
                    limit: MAX_COMPARISONS,
                    pointer: Some(accessor.pointer()),
                });
            }
        }
        Ok(())
    }

    /// Whether the accessor holds the positions of some primitive.
    pub fn is_position(&self, accessor: usize) -> bool {
        self.is_position.get(accessor) == Some(&true)
    }

    /// Whether each element of a position accessor has to stay as it is.
    pub fn fixed(&self, accessor: &Accessor, slots: &[Option<Slot>]) -> Vec<bool> {
        let near: Vec<&Use> = accessor
            .regions()
            .flat_map(|region| self.near(region))
            .collect();
        let size = accessor.format.position_size();
        let clashes = |usage: &Use, slot: Slot| {
            let is_same = usage.format == Some(accessor.format) && usage.region.has(slot);
            !is_same && usage.region.overlaps(slot, size)
        };
        let is_fixed = |slot: Slot| near.iter().any(|usage| clashes(usage, slot));
        slots.iter().map(|slot| slot.is_none_or(is_fixed)).collect()
    }

    /// The uses of bytes between the ends of a region. O(log of all uses) for each.
    fn near(&self, region: &Region) -> Vec<&Use> {
        let after = self.uses.partition_point(|usage| {
            (usage.region.storage, usage.region.start) < (region.storage, region.end())
        });
        let num_leaves = self.reach.len().checked_div(2).unwrap_or(0);
        let mut near = Vec::new();
        let mut open = vec![1_usize];
        while let Some(node) = open.pop() {
            let reaches = self.reach.get(node);
            if reaches.is_none_or(|&reach| reach <= (region.storage, region.start)) {
                continue;
            }
            // The first leaf below the node.
            let height = num_leaves.ilog2().saturating_sub(node.ilog2());
            let leaf = (node << height).saturating_sub(num_leaves);
            if leaf >= after {
                continue;
            }
            if height > 0 {
                let child = node.saturating_mul(2);
                open.extend([child.saturating_add(1), child]);
            } else {
                let usage = self.uses.get(leaf);
                near.extend(usage.filter(|usage| !usage.region.apart(region)));
            }
        }
        near
    }
}

/// The tree of the largest ends.
fn reach(uses: &[Use]) -> Vec<(usize, usize)> {
    let num_leaves = uses.len().next_power_of_two();
    let mut tree = vec![(0, 0); num_leaves.saturating_mul(2)];
    let leaves = tree.iter_mut().skip(num_leaves);
    for (leaf, usage) in leaves.zip(uses) {
        *leaf = (usage.region.storage, usage.region.end());
    }
    for node in (1..num_leaves).rev() {
        let child = node.saturating_mul(2);
        let children = tree.get(child..).and_then(<[_]>::first_chunk::<2>);
        let largest = children.map(|[a, b]| *a.max(b));
        if let (Some(slot), Some(largest)) = (tree.get_mut(node), largest) {
            *slot = largest;
        }
    }
    tree
}

/// The uses in order. Of those that differ in their number of elements alone, the one with most: it has the others' bytes.
fn sorted(uses: Vec<(Region, Option<Format>)>) -> Vec<Use> {
    let key = |(region, format): &(Region, Option<Format>)| {
        let [storage, start, stride, size, count] = region.words();
        let format = format.map_or([0; 2], |format| {
            let component = u64::from(format.component.as_gl_enum());
            [component, u64::from(format.normalized)]
        });
        [
            storage,
            start,
            stride,
            size,
            format[0],
            format[1],
            u64::MAX.saturating_sub(count),
        ]
    };
    let keys: Vec<[u64; 7]> = uses.iter().map(key).collect();
    let mut order = order_by_words(&keys);
    order.dedup_by_key(|index| {
        let [rest @ .., _] = keys.get(*index as usize)?;
        Some(rest)
    });
    let once = order
        .into_iter()
        .filter_map(|index| uses.get(index as usize).cloned());
    once.map(|(region, format)| Use { region, format })
        .collect()
}

/// The buffer views of images, and those that nothing known refers to, as one element each.
fn whole_views(root: &Root, views: &[View]) -> Vec<Region> {
    let mut by_accessor = vec![false; views.len()];
    for accessor in &root.accessors {
        accessor
            .buffer_view
            .into_iter()
            .for_each(|view| mark(&mut by_accessor, view));
        if let Some(sparse) = &accessor.sparse {
            mark(&mut by_accessor, sparse.indices.buffer_view);
            mark(&mut by_accessor, sparse.values.buffer_view);
        }
    }
    let mut by_image = vec![false; views.len()];
    root.images
        .iter()
        .filter_map(|image| image.buffer_view)
        .for_each(|view| mark(&mut by_image, view));

    let uses = by_accessor.iter().zip(by_image);
    let whole = views
        .iter()
        .zip(uses)
        .filter(|(_, (by_accessor, by_image))| !**by_accessor || *by_image);
    whole.filter_map(|(view, _)| view.whole()).collect()
}

/// Sets the flag of an item that is known to be in the list.
fn mark(flags: &mut [bool], index: u64) {
    let flag = usize::try_from(index)
        .ok()
        .and_then(|index| flags.get_mut(index));
    flag.into_iter().for_each(|flag| *flag = true);
}
