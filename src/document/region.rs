//! Runs of equally spaced elements in the bytes of a document: buffer views, and accessors in them.

use std::fmt;

use super::buffer::Buffer;
use super::schema::{BufferView, Root};
use super::{DocumentError, item};

/// The bytes of one element. Equal slots are the same bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Slot {
    /// The run of bytes: a number that belongs to one file, data URI or GLB chunk.
    pub storage: usize,
    /// The element's first byte in it.
    pub offset: usize,
}

/// Elements of `size` bytes, `stride` >= `size` bytes apart, that lie within their storage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub storage: usize,
    pub start: usize,
    stride: usize,
    pub size: usize,
    pub count: usize,
}

/// A buffer view that lies within its buffer.
pub(super) struct View {
    storage: usize,
    start: u64,
    length: u64,
    stride: Option<u64>,
}

/// The buffer views of the file.
pub(super) fn views(root: &Root, buffers: &[Buffer]) -> Result<Vec<View>, DocumentError> {
    let view = |(index, view): (usize, &BufferView)| {
        let (_, buffer) = item(
            buffers,
            view.buffer,
            "buffers",
            format_args!("/bufferViews/{index}/buffer"),
        )?;
        let end = view.byte_offset.saturating_add(view.byte_length);
        if end > buffer.length {
            return Err(DocumentError::OutOfBounds {
                pointer: format!("/bufferViews/{index}"),
                needed: end,
                available: buffer.length,
            });
        }
        Ok(View {
            storage: buffer.storage,
            start: view.byte_offset,
            length: view.byte_length,
            stride: view.byte_stride,
        })
    };
    root.buffer_views.iter().enumerate().map(view).collect()
}

impl View {
    /// All bytes of the view as one element.
    pub fn whole(&self) -> Option<Region> {
        let size = usize::try_from(self.length).ok()?;
        Some(Region {
            storage: self.storage,
            start: usize::try_from(self.start).ok()?,
            stride: size,
            size,
            count: 1,
        })
    }

    /// The elements of an accessor, `pointer`, that starts at `offset` in the view.
    pub fn elements(
        &self,
        offset: u64,
        size: usize,
        count: u64,
        pointer: fmt::Arguments,
    ) -> Result<Region, DocumentError> {
        let stride = self.stride.unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(DocumentError::BadAccessor {
                pointer: pointer.to_string(),
                detail: format!(
                    "its elements have {size} bytes, but follow each other every {stride} bytes"
                ),
            });
        }
        let needed = match count.checked_sub(1) {
            Some(last) => last
                .saturating_mul(stride)
                .saturating_add(size as u64)
                .saturating_add(offset),
            None => offset,
        };
        let out_of_bounds = || DocumentError::OutOfBounds {
            pointer: pointer.to_string(),
            needed,
            available: self.length,
        };
        if needed > self.length {
            return Err(out_of_bounds());
        }
        // All of these are lengths within bytes in memory, except the stride of a single element.
        let in_memory = |value: u64| usize::try_from(value).map_err(|_| out_of_bounds());
        Ok(Region {
            storage: self.storage,
            start: in_memory(self.start.saturating_add(offset))?,
            stride: in_memory(stride)?,
            size,
            count: in_memory(count)?,
        })
    }

    /// Like [`elements`](Self::elements) for data that has to be tightly packed: readers differ in
    /// whether they heed a stride that should not be there.
    pub fn packed_elements(
        &self,
        offset: u64,
        size: usize,
        count: u64,
        pointer: fmt::Arguments,
    ) -> Result<Region, DocumentError> {
        match self.stride {
            Some(stride) if stride != size as u64 => Err(DocumentError::BadAccessor {
                pointer: pointer.to_string(),
                detail: format!(
                    "its buffer view has a byte stride of {stride}, but sparse data is tightly packed"
                ),
            }),
            _ => self.elements(offset, size, count, pointer),
        }
    }
}

impl Region {
    /// All that the region is, its place first.
    pub fn words(&self) -> [u64; 5] {
        let Self {
            storage,
            start,
            stride,
            size,
            count,
        } = *self;
        [storage, start, stride, size, count].map(|word| word as u64)
    }

    /// The slot of element `index`.
    pub fn slot(&self, index: usize) -> Option<Slot> {
        let offset = index.checked_mul(self.stride)?.checked_add(self.start)?;
        (index < self.count).then_some(Slot {
            storage: self.storage,
            offset,
        })
    }

    /// Whether an element of the region is exactly the bytes of `slot`.
    pub fn has(&self, slot: Slot) -> bool {
        let index = slot
            .offset
            .checked_sub(self.start)
            .and_then(|distance| distance.checked_div(self.stride));
        index.is_some_and(|index| self.slot(index) == Some(slot))
    }

    /// Whether an element of the region shares a byte with the `size` bytes of `slot`.
    pub fn overlaps(&self, slot: Slot, size: usize) -> bool {
        if self.count == 0 || self.size == 0 || slot.storage != self.storage {
            return false;
        }
        let Some(distance) = slot.offset.checked_sub(self.start) else {
            return slot.offset.saturating_add(size) > self.start;
        };
        let (Some(index), Some(phase)) = (
            distance.checked_div(self.stride),
            distance.checked_rem(self.stride),
        ) else {
            return false;
        };
        let in_element = index < self.count && phase < self.size;
        let into_next =
            index.saturating_add(1) < self.count && phase.saturating_add(size) > self.stride;
        in_element || into_next
    }

    /// Whether the two regions lie side by side, so that no elements of theirs can overlap.
    pub fn apart(&self, other: &Region) -> bool {
        self.storage != other.storage || self.end() <= other.start || other.end() <= self.start
    }

    /// The offset after the last element.
    pub fn end(&self) -> usize {
        let last = self.count.checked_sub(1).and_then(|last| self.slot(last));
        last.map_or(self.start, |last| last.offset.saturating_add(self.size))
    }
}
