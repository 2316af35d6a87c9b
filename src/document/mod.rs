//! glTF 2.0 documents, read and written without loss.
//!
//! A [`Document`] is a model file (`.glb` or `.gltf`) with the external buffers it names. It gives
//! out what concerns geometry, takes new vertex positions, and writes the file again: byte for byte
//! the input if no position changed, otherwise with nothing else changed than the bytes of those
//! positions and the numbers in `min` and `max` of their accessors. Extensions, `extras`, the order
//! and spelling of everything in the JSON text, padding and unknown chunks stay as they are, because
//! writing edits spans of the original text and patches the original bytes.
//!
//! The module knows bytes and numbers, not geometry. The schema is read through types of its own
//! which borrow from the text (`schema.rs` says why), with the `gltf` crate's enumerations.
//! `KHR_mesh_quantization`, which that crate refuses, is read here; required extensions that may concern
//! positions are refused. Compressed geometry (feature `codec`) is read as the plain document that it stands
//! for, and written so if it changed.
//!
//! All offsets and lengths of the file are checked while reading, before anything is allocated for
//! them, so the memory used is a small multiple of the input's size; what the file can ask for without
//! data (nodes, elements that are stored nowhere, accessors of the same bytes) is limited. Malformed
//! input is an error and never a panic.
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects
)]

mod accessor;
mod bounds;
mod buffer;
#[cfg(feature = "codec")]
mod codec;
mod container;
mod data_uri;
mod error;
mod extension;
mod instances;
mod json;
mod links;
mod mesh;
mod node;
mod region;
mod schema;
mod sharing;
mod splice;
mod tree;

use std::collections::BTreeMap;
use std::fmt;

use self::accessor::Accessor;
use self::buffer::{Origin, Storage};
use self::region::{Region, View};
use self::schema::Root;
use self::sharing::Sharing;
use self::splice::Splice;

pub use self::container::Container;
pub use self::error::DocumentError;
pub use self::mesh::{MAX_UNBACKED, Mesh, Primitive};
pub use self::node::{Node, Transform};
pub use self::region::Slot;
pub use gltf::json::mesh::Mode;

/// External files by the URI that the `.gltf` file names them with, percent-decoded.
pub type Files = BTreeMap<String, Vec<u8>>;

/// A written document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The `.glb` or `.gltf` file.
    pub model: Vec<u8>,
    /// The external buffers that changed, by the names they were handed in with.
    pub files: Files,
    /// Whether it is compressed, as its host was.
    pub is_packed: bool,
    /// The compression that the file had and has no more: of a document that changed, all of it.
    pub unpacked: Vec<&'static str>,
}

/// The values that the components of an accessor's positions can take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionGrid {
    /// Single-precision floating-point numbers.
    Float32,
    /// The multiples of `step` from `min` to `max`: integers, or integers normalized to [-1, 1] or
    /// [0, 1], by `KHR_mesh_quantization`.
    Integer {
        /// The distance between neighbouring values.
        step: f64,
        /// The smallest value.
        min: f64,
        /// The largest value.
        max: f64,
    },
}

/// A glTF 2.0 document.
pub struct Document {
    container: Container,
    text: String,
    rest: Vec<u8>,
    storages: Vec<Storage>,
    accessors: Vec<Accessor>,
    sharing: Sharing,
    extensions_used: Vec<String>,
    meshes: Vec<Mesh>,
    nodes: Vec<Node>,
    roots: Vec<usize>,
    num_stated_nodes: usize,
    tail: Vec<u8>,
    packed: Option<Packed>,
}

/// What a document was read from, if its geometry was compressed: the rest of it is a plain one.
struct Packed {
    model: Vec<u8>,
    extensions: Vec<&'static str>,
    #[cfg(feature = "codec")]
    host: codec::Host,
}

impl Document {
    /// Reads a model file: GLB if it starts with GLB's magic number, otherwise JSON text, with a
    /// byte order mark or without. `files` holds at least the external buffers the model names;
    /// images are not looked for.
    ///
    /// # Errors
    ///
    /// Any [`DocumentError`] of malformed, incomplete or unsupported input. The values of positions
    /// and vertex indices are only checked by [`positions`](Self::positions) and
    /// [`triangles`](Self::triangles).
    pub fn read(model: &[u8], files: &Files) -> Result<Self, DocumentError> {
        let parts = container::split(model)?;
        #[cfg(feature = "codec")]
        if let Some(unpacked) = codec::unpacked(&parts, files)? {
            let packed = Packed {
                model: model.to_vec(),
                extensions: unpacked.extensions,
                host: codec::Host {
                    parts,
                    files: files.clone(),
                },
            };
            return Self::of_parts(unpacked.parts, &unpacked.files, Some(packed));
        }
        Self::of_parts(parts, files, None)
    }

    fn of_parts(
        parts: container::Parts,
        files: &Files,
        packed: Option<Packed>,
    ) -> Result<Self, DocumentError> {
        let text = parts.text;
        let root = Root::parse(&text)?;
        extension::check_compression(&root)?;
        extension::check_required(&root)?;
        let (storages, buffers) = buffer::resolve(&root, &text, parts.binary, files)?;
        let views = region::views(&root, &buffers)?;
        let accessors = accessor::read(&root, &text, &views)?;
        let meshes = mesh::read(&root, &accessors)?;
        let (nodes, roots) = tree::read(&root, &accessors, &storages)?;
        let num_stated_nodes = root.nodes.len();
        check_references(&root, &accessors, &views)?;
        let sharing = Sharing::new(&root, &accessors, &views)?;
        let is_sparse_position = |accessor: &&Accessor| {
            accessor.index_region().is_some() && sharing.is_position(accessor.index)
        };
        for accessor in accessors.iter().filter(is_sparse_position) {
            accessor.slots(&storages)?;
        }
        let mut extensions_used = root.extensions_used;
        let unpacked = packed.iter().flat_map(|packed| &packed.extensions);
        extensions_used.extend(unpacked.map(ToString::to_string));
        Ok(Self {
            container: parts.container,
            text,
            rest: parts.rest,
            storages,
            accessors,
            sharing,
            extensions_used,
            meshes,
            nodes,
            roots,
            num_stated_nodes,
            tail: parts.tail,
            packed,
        })
    }

    /// The external buffers that a model file names, percent-decoded, each once: what [`read`](Self::read) wants to have as `files`.
    ///
    /// # Errors
    ///
    /// Any [`DocumentError`] that says so much of the file is malformed or unsupported, whatever the buffers hold.
    pub fn file_names(model: &[u8]) -> Result<Vec<String>, DocumentError> {
        let parts = container::split(model)?;
        let root = Root::parse(&parts.text)?;
        #[cfg(not(feature = "codec"))]
        extension::check_compression(&root)?;
        extension::check_required(&root)?;
        buffer::file_names(&root)
    }

    /// The files beside it that a model file names, percent-decoded, each once: buffers, images, sounds, what extensions name. What a
    /// complete copy of the model consists of, beside the model file.
    ///
    /// # Errors
    ///
    /// [`DocumentError`] of a container or a text that cannot be read.
    pub fn linked_files(model: &[u8]) -> Result<Vec<String>, DocumentError> {
        links::relative(&container::split(model)?.text)
    }

    /// Writes the document: byte for byte what was read, except for positions that are not what
    /// they were, and `min` and `max` of the accessors that contain them.
    ///
    /// # Errors
    ///
    /// [`DocumentError::TooLarge`] if new `min` and `max` make a GLB file exceed 4 GiB.
    pub fn write(&self) -> Result<Written, DocumentError> {
        let is_changed = self
            .storages
            .iter()
            .any(|storage| storage.changed().is_some());
        match &self.packed {
            Some(packed) if !is_changed => Ok(Written {
                model: packed.model.clone(),
                files: Files::new(),
                is_packed: true,
                unpacked: Vec::new(),
            }),
            #[cfg(feature = "codec")]
            Some(packed) => match self.write_packed(packed)? {
                Some(written) => Ok(written),
                None => self.write_plain(),
            },
            _ => self.write_plain(),
        }
    }

    /// Writes the document compressed as its host was; `None` where that cannot be done. What a decoder makes of it decides the bounds: codecs
    /// may round.
    #[cfg(feature = "codec")]
    fn write_packed(&self, packed: &Packed) -> Result<Option<Written>, DocumentError> {
        let host = &packed.host;
        let ([storage], true) = (self.storages.as_slice(), self.has_buffer_of_its_own()) else {
            return Ok(None);
        };
        let Some(again) = host.packed(&self.text, storage)? else {
            return Ok(None);
        };
        let model = |splice: Splice| {
            let mut text = splice.finish();
            if self.container == Container::Glb && text.len() != host.parts.text.len() {
                container::pad(&mut text);
            }
            container::join(
                self.container,
                &text,
                again.chunk.as_deref(),
                &self.rest,
                &self.tail,
            )
        };
        let mut files = host.files.clone();
        files.extend(again.files.clone());
        let Ok(seen) = Self::read(&model(again.splice.clone())?, &files) else {
            return Ok(None);
        };
        let root = Root::parse(&host.parts.text)?;
        let mut splice = again.splice.clone();
        for (accessor, stated) in self.accessors.iter().zip(&root.accessors) {
            let slots = accessor.slots(&self.storages)?;
            let size = accessor.format.position_size();
            let has_changed = |slot: &Slot| storage.has_changed(slot.offset, size);
            let is_changed =
                self.sharing.is_position(accessor.index) && slots.iter().flatten().any(has_changed);
            if let Some(accessor) = seen.accessors.get(accessor.index).filter(|_| is_changed) {
                let spans = [stated.min, stated.max]
                    .map(|bound| json::span(&host.parts.text, bound?.get()));
                let slots = accessor.slots(&seen.storages)?;
                bounds::make_true(accessor, &spans, &slots, &seen.storages, &mut splice);
            }
        }
        Ok(Some(Written {
            model: model(splice)?,
            files: again.files,
            is_packed: true,
            unpacked: Vec::new(),
        }))
    }

    /// Whether the plain data stands apart from the text.
    #[cfg(feature = "codec")]
    fn has_buffer_of_its_own(&self) -> bool {
        let origins = self.storages.iter().map(|storage| &storage.origin);
        origins
            .into_iter()
            .all(|origin| !matches!(origin, Origin::DataUri(_)))
    }

    /// Writes the document as [`write`](Self::write) does, but without compression even if nothing changed.
    ///
    /// # Errors
    ///
    /// As [`write`](Self::write).
    pub fn write_plain(&self) -> Result<Written, DocumentError> {
        let changed: Vec<Option<&[u8]>> = self.storages.iter().map(Storage::changed).collect();
        let has_changed =
            |region: &Region| changed.get(region.storage).is_some_and(Option::is_some);
        let mut splice = Splice::new(&self.text);
        for accessor in self
            .accessors
            .iter()
            .filter(|accessor| self.sharing.is_position(accessor.index))
        {
            if accessor.regions().any(has_changed) {
                let slots = accessor.slots(&self.storages)?;
                bounds::correct(accessor, &slots, &self.storages, &mut splice);
            }
        }
        let mut files = Files::new();
        let mut binary = None;
        for (storage, changed) in self.storages.iter().zip(changed) {
            match (&storage.origin, changed) {
                (Origin::Chunk, _) => binary = Some(storage.bytes()),
                (Origin::DataUri(payload), Some(bytes)) => {
                    let old = splice.get(payload.clone());
                    let new = data_uri::replace(old, &storage.original, bytes);
                    splice.replace(payload.clone(), new);
                }
                (Origin::File(name), Some(bytes)) => {
                    files.insert(name.clone(), bytes.to_vec());
                }
                // A file of plain data, that nobody has yet.
                (Origin::File(name), None) if self.packed.is_some() => {
                    files.insert(name.clone(), storage.bytes().to_vec());
                }
                (_, None) => {}
            }
        }
        let mut text = splice.finish();
        if self.container == Container::Glb && text.len() != self.text.len() {
            container::pad(&mut text);
        }
        let model = container::join(self.container, &text, binary, &self.rest, &self.tail)?;
        let unpacked = self
            .packed
            .as_ref()
            .map_or(&[][..], |packed| &packed.extensions);
        Ok(Written {
            model,
            files,
            is_packed: false,
            unpacked: unpacked.to_vec(),
        })
    }

    /// How the model file is packed.
    pub fn container(&self) -> Container {
        self.container
    }

    /// The names in `extensionsUsed`.
    pub fn extensions_used(&self) -> &[String] {
        &self.extensions_used
    }

    /// The meshes; nodes and [`triangles`](Self::triangles) refer to them by index.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// The nodes: those of the file in its order, then instances, then a copy for every further way that a node is shown. They form
    /// trees: none has two parents, none is its own descendant.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// How many nodes the file states.
    pub fn num_stated_nodes(&self) -> usize {
        self.num_stated_nodes
    }

    /// The root nodes of all scenes, each once, in ascending order; all nodes without a parent if
    /// the file has no scene.
    pub fn roots(&self) -> &[usize] {
        &self.roots
    }

    /// The positions of an accessor, dequantized, with sparse values in place: one per element, in
    /// the units of the file. Those that are no finite numbers are given too: it depends on their use whether they matter.
    ///
    /// # Errors
    ///
    /// [`DocumentError::NotPositions`] if no primitive uses the accessor as `POSITION`.
    pub fn positions(&self, accessor: usize) -> Result<Vec<[f64; 3]>, DocumentError> {
        let accessor = self.position_accessor(accessor)?;
        accessor.each(&self.storages, |_, slot| Ok(self.position(accessor, slot)))
    }

    /// The number of elements of a position accessor; nothing is read for it.
    ///
    /// # Errors
    ///
    /// [`DocumentError::NotPositions`].
    pub fn num_positions(&self, accessor: usize) -> Result<usize, DocumentError> {
        Ok(self.position_accessor(accessor)?.count)
    }

    /// The number of triangles that [`triangles`](Self::triangles) gives; nothing is read for it. 0 if there is no such primitive.
    pub fn num_triangles(&self, mesh: usize, primitive: usize) -> usize {
        self.primitive(mesh, primitive).map_or(0, |primitive| {
            mesh::num_triangles(primitive, &self.accessors)
        })
    }

    /// The number of elements of an accessor that are zero because they are stored nowhere; nothing is read for it. 0 if there is no
    /// such accessor.
    pub fn num_unbacked(&self, accessor: usize) -> usize {
        self.accessors
            .get(accessor)
            .map_or(0, Accessor::num_unbacked)
    }

    /// The values that positions of an accessor can take.
    ///
    /// # Errors
    ///
    /// [`DocumentError::NotPositions`].
    pub fn position_grid(&self, accessor: usize) -> Result<PositionGrid, DocumentError> {
        let format = self.position_accessor(accessor)?.format;
        let (min, max) = format.range();
        Ok(if format.is_float() {
            PositionGrid::Float32
        } else {
            PositionGrid::Integer {
                step: 1.0 / format.scale(),
                min,
                max,
            }
        })
    }

    /// The bytes that store each element of a position accessor, `None` for elements that are zero
    /// because a sparse accessor without a buffer view does not list them. Elements with equal slots,
    /// of one accessor or of several, are the same bytes: a change of one is a change of all.
    ///
    /// # Errors
    ///
    /// [`DocumentError::NotPositions`].
    pub fn slots(&self, accessor: usize) -> Result<Vec<Option<Slot>>, DocumentError> {
        self.position_accessor(accessor)?.slots(&self.storages)
    }

    /// Whether each element of a position accessor has to keep its value: because it is not stored,
    /// or because some of its bytes have another use as well (normals, indices, morph targets,
    /// animations, images, data of unknown use, or positions that overlap it in part or in another
    /// number format).
    ///
    /// # Errors
    ///
    /// [`DocumentError::NotPositions`].
    pub fn fixed_elements(&self, accessor: usize) -> Result<Vec<bool>, DocumentError> {
        let accessor = self.position_accessor(accessor)?;
        let slots = accessor.slots(&self.storages)?;
        Ok(self.sharing.fixed(accessor, &slots))
    }

    /// Whether the accessor holds positions of which at least one can be changed.
    pub fn is_writable(&self, accessor: usize) -> bool {
        self.fixed_elements(accessor)
            .is_ok_and(|fixed| fixed.contains(&false))
    }

    /// The triangles of a primitive as indices into its positions, in the winding of the glTF 2.0
    /// specification (section 3.7.2.1), from lists, strips and fans, indexed or not. Vertices left
    /// over at the end form no triangle. Empty for points, lines, and primitives without positions.
    ///
    /// # Errors
    ///
    /// [`DocumentError::NotPositions`] if there is no such primitive, [`DocumentError::BadVertex`],
    /// [`DocumentError::PrimitiveRestart`], and [`DocumentError::BadAccessor`] for wrong sparse indices.
    pub fn triangles(&self, mesh: usize, primitive: usize) -> Result<Vec<[u32; 3]>, DocumentError> {
        let pointer = format!("/meshes/{mesh}/primitives/{primitive}");
        match self.primitive(mesh, primitive) {
            Some(primitive) => {
                mesh::triangles(primitive, &self.accessors, &self.storages, &pointer)
            }
            None => Err(DocumentError::NotPositions { pointer }),
        }
    }

    /// Stores new positions, one for every element of the accessor. Each component becomes the
    /// nearest value of the accessor's [`grid`](Self::position_grid), within its range; bytes are
    /// only touched where that value is not the stored one, so storing what
    /// [`positions`](Self::positions) gave changes nothing. Elements of other accessors in the same
    /// [`slots`](Self::slots) change as well; of elements given twice the later one counts.
    ///
    /// # Errors
    ///
    /// [`DocumentError::WrongLength`], [`DocumentError::NonFinitePosition`] for a new position, and
    /// [`DocumentError::FixedElement`] for a [fixed element](Self::fixed_elements) that would change,
    /// as well as the errors of [`positions`](Self::positions). Nothing is stored then.
    pub fn set_positions(
        &mut self,
        accessor: usize,
        positions: &[[f64; 3]],
    ) -> Result<(), DocumentError> {
        let accessor = self.position_accessor(accessor)?;
        let format = accessor.format;
        if positions.len() != accessor.count {
            return Err(DocumentError::WrongLength {
                pointer: accessor.pointer(),
                given: positions.len(),
                count: accessor.count,
            });
        }
        let slots = accessor.slots(&self.storages)?;
        let fixed = self.sharing.fixed(accessor, &slots);
        let mut patches = Vec::new();
        for (element, (position, (slot, fixed))) in positions
            .iter()
            .zip(slots.into_iter().zip(fixed))
            .enumerate()
        {
            let stored = self.position(accessor, slot);
            if position.map(f64::to_bits) == stored.map(f64::to_bits) {
                continue;
            }
            if !position.iter().all(|component| component.is_finite()) {
                return Err(DocumentError::NonFinitePosition {
                    pointer: accessor.pointer(),
                    element,
                });
            }
            let nearest = position.map(|component| format.nearest(component));
            if nearest == stored {
                continue;
            }
            match slot {
                Some(slot) if !fixed => patches.push((slot, nearest, stored)),
                _ => {
                    return Err(DocumentError::FixedElement {
                        pointer: accessor.pointer(),
                        element,
                    });
                }
            }
        }
        for (slot, nearest, stored) in patches {
            let Some(storage) = self.storages.get_mut(slot.storage) else {
                continue;
            };
            let size = format.component.size();
            let offsets =
                (0..3_usize).map(|axis| axis.saturating_mul(size).saturating_add(slot.offset));
            for (offset, (new, old)) in offsets.zip(nearest.into_iter().zip(stored)) {
                if new != old {
                    storage.patch(offset, format.encode(new).get(..size).unwrap_or_default());
                }
            }
        }
        Ok(())
    }

    fn primitive(&self, mesh: usize, primitive: usize) -> Option<&Primitive> {
        self.meshes.get(mesh)?.primitives.get(primitive)
    }

    /// The accessor, if it holds positions.
    fn position_accessor(&self, index: usize) -> Result<&Accessor, DocumentError> {
        let accessor = self
            .accessors
            .get(index)
            .filter(|_| self.sharing.is_position(index));
        accessor.ok_or_else(|| DocumentError::NotPositions {
            pointer: format!("/accessors/{index}"),
        })
    }

    fn position(&self, accessor: &Accessor, slot: Option<Slot>) -> [f64; 3] {
        let raw = slot.and_then(|slot| accessor.format.raw_position(&self.storages, slot));
        raw.unwrap_or_default()
            .map(|component| accessor.format.normalize(component))
    }
}

/// Refuses references to accessors and buffer views that nothing else resolves.
fn check_references(
    root: &Root,
    accessors: &[Accessor],
    views: &[View],
) -> Result<(), DocumentError> {
    for (index, image) in root.images.iter().enumerate() {
        if let Some(view) = image.buffer_view {
            item(
                views,
                view,
                "bufferViews",
                format_args!("/images/{index}/bufferView"),
            )?;
        }
    }
    for (index, animation) in root.animations.iter().enumerate() {
        for (place, sampler) in animation.samplers.iter().enumerate() {
            for (accessor, end) in [(sampler.input, "input"), (sampler.output, "output")] {
                let pointer = format_args!("/animations/{index}/samplers/{place}/{end}");
                item(accessors, accessor, "accessors", pointer)?;
            }
        }
    }
    Ok(())
}

/// The item of a list of the file that an index refers to.
fn item<'a, T>(
    list: &'a [T],
    index: u64,
    name: &'static str,
    pointer: fmt::Arguments,
) -> Result<(usize, &'a T), DocumentError> {
    let position = usize::try_from(index).ok();
    let item = position.and_then(|position| Some((position, list.get(position)?)));
    item.ok_or_else(|| DocumentError::BadIndex {
        pointer: pointer.to_string(),
        list: name,
        index,
        count: list.len(),
    })
}
