//! Accessors (glTF 2.0 specification section 3.6.2): where elements are stored, and as what numbers.

use std::ops::Range;

use gltf::json::accessor::{ComponentType, Type};

use super::buffer::Storage;
use super::json;
use super::region::{Region, Slot, View};
use super::schema::{self, Root};
use super::{DocumentError, item};

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Format {
    pub component: ComponentType,
    pub normalized: bool,
}

/// An accessor whose elements all lie within their buffers.
pub(super) struct Accessor {
    pub index: usize,
    pub kind: Type,
    pub format: Format,
    pub count: usize,
    base: Option<Region>,
    sparse: Option<Sparse>,
    /// Where `min` and `max` stand in the JSON text.
    pub bounds: [Option<Range<usize>>; 2],
}

struct Sparse {
    indices: Region,
    index_component: ComponentType,
    values: Region,
}

/// The accessors of the file.
pub(super) fn read(
    root: &Root,
    text: &str,
    views: &[View],
) -> Result<Vec<Accessor>, DocumentError> {
    let accessors = root.accessors.iter().enumerate();
    accessors
        .map(|(index, accessor)| Accessor::read(index, accessor, text, views))
        .collect()
}

impl Accessor {
    fn read(
        index: usize,
        accessor: &schema::Accessor,
        text: &str,
        views: &[View],
    ) -> Result<Self, DocumentError> {
        let bad = |property: &str, detail: &str| DocumentError::BadAccessor {
            pointer: format!("/accessors/{index}/{property}"),
            detail: detail.into(),
        };
        let (kind, component) = (accessor.kind, accessor.component_type);
        let size = element_size(kind, component);
        let view = |view: u64, property: &str| {
            let pointer = format_args!("/accessors/{index}/{property}");
            Ok::<_, DocumentError>(item(views, view, "bufferViews", pointer)?.1)
        };

        let base = match accessor.buffer_view {
            Some(base) => Some(view(base, "bufferView")?.elements(
                accessor.byte_offset,
                size,
                accessor.count,
                format_args!("/accessors/{index}"),
            )?),
            None => None,
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => {
                let index_component = sparse.indices.component_type;
                if !is_index(index_component) {
                    return Err(bad(
                        "sparse/indices/componentType",
                        "the number type cannot be an index",
                    ));
                }
                if sparse.count > accessor.count {
                    return Err(bad(
                        "sparse/count",
                        "more elements are replaced than there are",
                    ));
                }
                Some(Sparse {
                    indices: view(sparse.indices.buffer_view, "sparse/indices/bufferView")?
                        .packed_elements(
                            sparse.indices.byte_offset,
                            index_component.size(),
                            sparse.count,
                            format_args!("/accessors/{index}/sparse/indices"),
                        )?,
                    index_component,
                    values: view(sparse.values.buffer_view, "sparse/values/bufferView")?
                        .packed_elements(
                            sparse.values.byte_offset,
                            size,
                            sparse.count,
                            format_args!("/accessors/{index}/sparse/values"),
                        )?,
                })
            }
            None => None,
        };
        let count = usize::try_from(accessor.count).map_err(|_| DocumentError::TooLarge {
            what: "the number of elements",
            value: accessor.count,
            limit: usize::MAX as u64,
            pointer: Some(format!("/accessors/{index}/count")),
        })?;
        Ok(Self {
            index,
            kind,
            format: Format {
                component,
                normalized: accessor.normalized && component != ComponentType::F32,
            },
            count,
            base,
            sparse,
            bounds: [accessor.min, accessor.max].map(|bound| json::span(text, bound?.get())),
        })
    }

    pub fn pointer(&self) -> String {
        format!("/accessors/{}", self.index)
    }

    /// The elements that are zero because they are stored nowhere: no data bounds their number.
    pub fn num_unbacked(&self) -> usize {
        let stored = match (&self.base, &self.sparse) {
            (Some(_), _) => self.count,
            (None, Some(sparse)) => sparse.values.count,
            (None, None) => 0,
        };
        self.count.saturating_sub(stored)
    }

    /// The elements' places: the base elements and the sparse values.
    pub fn regions(&self) -> impl Iterator<Item = &Region> {
        self.base
            .iter()
            .chain(self.sparse.as_ref().map(|sparse| &sparse.values))
    }

    /// The places of the sparse indices.
    pub fn index_region(&self) -> Option<&Region> {
        self.sparse.as_ref().map(|sparse| &sparse.indices)
    }

    /// What `read` makes of the place of every element. Without a list of the places, if these follow from the element's number.
    pub fn each<T>(
        &self,
        storages: &[Storage],
        mut read: impl FnMut(usize, Option<Slot>) -> Result<T, DocumentError>,
    ) -> Result<Vec<T>, DocumentError> {
        match (&self.base, &self.sparse) {
            (Some(base), None) => (0..self.count)
                .map(|index| read(index, base.slot(index)))
                .collect(),
            _ => {
                let slots = self.slots(storages)?.into_iter().enumerate();
                slots.map(|(index, slot)| read(index, slot)).collect()
            }
        }
    }

    /// The place of every element, `None` for those that are zero because they are stored nowhere.
    pub fn slots(&self, storages: &[Storage]) -> Result<Vec<Option<Slot>>, DocumentError> {
        let mut slots: Vec<Option<Slot>> = match &self.base {
            Some(base) => (0..self.count).map(|index| base.slot(index)).collect(),
            None => vec![None; self.count],
        };
        let Some(sparse) = &self.sparse else {
            return Ok(slots);
        };
        let bad = |detail: String| DocumentError::BadAccessor {
            pointer: format!("{}/sparse/indices", self.pointer()),
            detail,
        };
        let mut previous = None;
        for place in 0..sparse.values.count {
            let index = sparse.indices.slot(place).and_then(|slot| {
                let bytes = bytes_at(storages, slot, sparse.indices.size)?;
                unsigned(sparse.index_component, bytes)
            });
            if index <= previous {
                return Err(bad(
                    "the replaced elements are not in ascending order".into()
                ));
            }
            previous = index;
            let index = index.and_then(|index| usize::try_from(index).ok());
            let slot = index.and_then(|index| slots.get_mut(index));
            *slot.ok_or_else(|| {
                bad(format!(
                    "a replaced element is beyond the {} there are",
                    self.count
                ))
            })? = sparse.values.slot(place);
        }
        Ok(slots)
    }
}

/// The bytes of an element.
pub(super) fn bytes_at(storages: &[Storage], slot: Slot, size: usize) -> Option<&[u8]> {
    storages
        .get(slot.storage)?
        .bytes()
        .get(slot.offset..)?
        .get(..size)
}

/// Whether numbers of this type can be vertex indices.
pub(super) fn is_index(component: ComponentType) -> bool {
    matches!(
        component,
        ComponentType::U8 | ComponentType::U16 | ComponentType::U32
    )
}

/// A number of an index type, and `None` for other types.
pub(super) fn unsigned(component: ComponentType, bytes: &[u8]) -> Option<u32> {
    Some(match component {
        ComponentType::U8 => u32::from(*bytes.first()?),
        ComponentType::U16 => u32::from(u16::from_le_bytes(*bytes.first_chunk()?)),
        ComponentType::U32 => u32::from_le_bytes(*bytes.first_chunk()?),
        ComponentType::I8 | ComponentType::I16 | ComponentType::F32 => return None,
    })
}

/// The bytes of an element; the columns of a matrix start at multiples of four (section 3.6.2.4).
fn element_size(kind: Type, component: ComponentType) -> usize {
    let columns = match kind {
        Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4 => {
            return kind.multiplicity().saturating_mul(component.size());
        }
        Type::Mat2 => 2_usize,
        Type::Mat3 => 3,
        Type::Mat4 => 4,
    };
    columns.saturating_mul(columns.saturating_mul(component.size()).next_multiple_of(4))
}

impl Format {
    /// Whether positions may be stored like this: f32, or by `KHR_mesh_quantization`.
    pub fn is_position(self) -> bool {
        self.component != ComponentType::U32
    }

    pub fn is_float(self) -> bool {
        self.component == ComponentType::F32
    }

    /// The bytes of a position.
    pub fn position_size(self) -> usize {
        self.component.size().saturating_mul(3)
    }

    /// The components of a position as they are stored.
    pub fn raw_position(self, storages: &[Storage], slot: Slot) -> Option<[f64; 3]> {
        let bytes = bytes_at(storages, slot, self.position_size())?;
        let mut components = bytes
            .chunks(self.component.size())
            .map(|component| self.raw(component));
        Some([
            components.next()??,
            components.next()??,
            components.next()??,
        ])
    }

    /// The representable value nearest to a finite one.
    pub fn nearest(self, value: f64) -> f64 {
        self.raw(&self.encode(value))
            .map_or(value, |raw| self.normalize(raw))
    }

    /// The number of integer steps in one unit; normalization is by section 3.11.
    pub fn scale(self) -> f64 {
        match (self.normalized, self.component) {
            (true, ComponentType::I8) => 127.0,
            (true, ComponentType::U8) => 255.0,
            (true, ComponentType::I16) => 32_767.0,
            (true, ComponentType::U16) => 65_535.0,
            _ => 1.0,
        }
    }

    /// The smallest and largest value of a component.
    pub fn range(self) -> (f64, f64) {
        let (low, high) = match self.component {
            ComponentType::I8 => (f64::from(i8::MIN), f64::from(i8::MAX)),
            ComponentType::U8 => (0.0, f64::from(u8::MAX)),
            ComponentType::I16 => (f64::from(i16::MIN), f64::from(i16::MAX)),
            ComponentType::U16 => (0.0, f64::from(u16::MAX)),
            ComponentType::U32 => (0.0, f64::from(u32::MAX)),
            ComponentType::F32 => (f64::from(f32::MIN), f64::from(f32::MAX)),
        };
        (self.normalize(low), self.normalize(high))
    }

    /// The value of a number as it is stored.
    pub fn normalize(self, raw: f64) -> f64 {
        if self.normalized {
            (raw / self.scale()).max(-1.0)
        } else {
            raw
        }
    }

    /// The number at the start of `bytes` as it is stored, before normalization.
    pub fn raw(self, bytes: &[u8]) -> Option<f64> {
        Some(match self.component {
            ComponentType::I8 => f64::from(i8::from_le_bytes(*bytes.first_chunk()?)),
            ComponentType::U8 => f64::from(*bytes.first()?),
            ComponentType::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            ComponentType::U16 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
            ComponentType::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            ComponentType::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
        })
    }

    /// The bytes of the representable value nearest to `value`, which is finite. Only the first
    /// `component.size()` count.
    pub fn encode(self, value: f64) -> [u8; 8] {
        let (low, high) = self.range();
        let value = value.clamp(low, high);
        let mut bytes = [0; 8];
        if self.component == ComponentType::F32 {
            let stored = (value as f32).to_le_bytes();
            bytes
                .iter_mut()
                .zip(stored)
                .for_each(|(byte, stored)| *byte = stored);
        } else {
            bytes = ((value * self.scale()).round() as i64).to_le_bytes();
        }
        bytes
    }
}
