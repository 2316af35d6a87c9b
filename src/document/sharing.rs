//! Which bytes serve what, and so which vertices can be moved without damage to other data.
//!
//! A position is fixed if any of its bytes also belongs to something that is not a vertex position
//! of the same number format: an accessor with another use (normals, indices, morph targets,
//! animations, or no known use), an image, or a buffer view that only an extension can be using.
//! Positions of two accessors may be the same bytes; then they are one position, and moving it
//! through one accessor moves it in the other. Positions that overlap in part are fixed.

use super::accessor::{Accessor, Format};
use super::region::{Region, Slot, View};
use super::schema::Root;
use crate::order::order_by_words;

/// The uses of the bytes of a document.
pub(super) struct Sharing {
    /// Whether each accessor holds the positions of some primitive.
    is_position: Vec<bool>,
    /// By storage and first byte.
    uses: Vec<Use>,
}

struct Use {
    region: Region,
    /// The number format of positions, `None` for every other use.
    format: Option<Format>,
    /// The largest end of this region and those before it in the same storage.
    reach: usize,
}

impl Sharing {
    pub fn new(root: &Root, accessors: &[Accessor], views: &[View]) -> Self {
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
        Self {
            is_position,
            uses: sorted(uses),
        }
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

    /// The uses of bytes between the ends of a region.
    fn near(&self, region: &Region) -> impl Iterator<Item = &Use> {
        let storage = region.storage;
        let first = self.uses.partition_point(|usage| {
            (usage.region.storage, usage.reach) <= (storage, region.start)
        });
        let after = self.uses.partition_point(|usage| {
            (usage.region.storage, usage.region.start) < (storage, region.end())
        });
        let uses = self.uses.get(first..after).unwrap_or_default();
        uses.iter().filter(|usage| !usage.region.apart(region))
    }
}

/// The uses in order, each once.
fn sorted(uses: Vec<(Region, Option<Format>)>) -> Vec<Use> {
    let key = |(region, format): &(Region, Option<Format>)| {
        let [storage, start, stride, size, count] = region.words();
        let format = format.map_or([0; 2], |format| {
            let component = u64::from(format.component.as_gl_enum());
            [component, u64::from(format.normalized)]
        });
        [storage, start, stride, size, count, format[0], format[1]]
    };
    let keys: Vec<[u64; 7]> = uses.iter().map(key).collect();
    let mut order = order_by_words(&keys);
    order.dedup_by_key(|index| keys.get(*index as usize));
    let mut reach = (0, 0);
    let once = order
        .into_iter()
        .filter_map(|index| uses.get(index as usize).cloned());
    let with_reach = once.map(|(region, format)| {
        reach = reach.max((region.storage, region.end()));
        Use {
            region,
            format,
            reach: reach.1,
        }
    });
    with_reach.collect()
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
