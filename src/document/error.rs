//! What can be wrong with a glTF file.

/// Why a glTF file cannot be read, changed or written.
///
/// The message is for the person who brought the file; [`code`](Self::code) and
/// [`pointer`](Self::pointer) are for programs.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// The bytes are neither a GLB container nor JSON text, or the container's structure is wrong.
    #[error("this is not a usable glTF file: {detail}")]
    BadContainer {
        /// What is wrong.
        detail: String,
    },
    /// The file, or a buffer of it, ends before the length it states.
    #[error(
        "the file is incomplete: {part} should have {needed} bytes, but only {available} are there"
    )]
    Truncated {
        /// The part that is too short.
        part: String,
        /// Bytes stated.
        needed: u64,
        /// Bytes present.
        available: u64,
        /// The property that states the length, where it is in the JSON text.
        pointer: Option<String>,
    },
    /// A glTF version other than 2.
    #[error(
        "glTF version {version} is not supported, only version 2 is: export the model as glTF 2.0"
    )]
    VersionUnsupported {
        /// The version the file states.
        version: String,
    },
    /// The JSON text is malformed, or a property has a wrong type or is missing.
    #[error("the glTF description is malformed: {detail}")]
    BadJson {
        /// The parser's words.
        detail: String,
        /// The object concerned, if it is known.
        pointer: Option<String>,
    },
    /// A reference to an object that is not in the file.
    #[error("the file refers to item {index} of \"{list}\", which has only {count}")]
    BadIndex {
        /// The reference.
        pointer: String,
        /// The list referred to.
        list: &'static str,
        /// The index given.
        index: u64,
        /// The number of items in the list.
        count: usize,
    },
    /// A buffer view reaches beyond its buffer, or an accessor beyond its buffer view.
    #[error(
        "data reaches beyond its end: {needed} bytes are needed where {available} are available"
    )]
    OutOfBounds {
        /// The buffer view or accessor.
        pointer: String,
        /// The bytes needed from the start of the buffer or buffer view (saturated).
        needed: u64,
        /// The length of the buffer or buffer view in bytes.
        available: u64,
    },
    /// An accessor that does not fit its use.
    #[error("unusable vertex data: {detail}")]
    BadAccessor {
        /// The property concerned.
        pointer: String,
        /// What is wrong.
        detail: String,
    },
    /// A position that is infinite or not a number, of a vertex that a triangle uses or as a new position.
    #[error("vertex {element} has a position that is not a finite number: repair the mesh first")]
    NonFinitePosition {
        /// The accessor.
        pointer: String,
        /// The element of the accessor.
        element: usize,
    },
    /// A triangle corner that is not a vertex of its primitive.
    #[error("a triangle uses vertex {vertex}, but the mesh part has only {count} vertices")]
    BadVertex {
        /// The primitive's indices.
        pointer: String,
        /// The index found.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// The largest value of an index type, which glTF 2.0 reserves for primitive restart and forbids: in a strip or a fan, or in a list
    /// without such a vertex.
    #[error(
        "the triangles contain the reserved value {value} (primitive restart), which glTF 2.0 forbids"
    )]
    PrimitiveRestart {
        /// The primitive's indices.
        pointer: String,
        /// The value found.
        value: u32,
    },
    /// Nodes that are their own descendants.
    #[error(
        "the scene graph has a loop: node {node} is its own descendant or belongs to such a node"
    )]
    CyclicNodes {
        /// The first such node.
        pointer: String,
        /// Its index.
        node: usize,
    },
    /// A required extension that is not known to leave positions alone.
    #[error("the file requires the glTF extension {name}, which is not supported")]
    ExtensionUnsupported {
        /// The entry of `extensionsRequired`.
        pointer: String,
        /// The extension.
        name: String,
    },
    /// Compressed geometry.
    #[error(
        "the model's geometry is compressed ({name}), and what reads it is not loaded: in JavaScript call initFull() first; or \
         decompress it, for example with `gltf-transform copy in.glb out.glb`"
    )]
    CompressionUnsupported {
        /// The place where compression is asked for.
        pointer: String,
        /// The extension.
        name: String,
    },
    /// Compressed geometry that no decoder makes sense of.
    #[error("the model's compressed geometry is damaged: {detail}")]
    BadCompression {
        /// Where the compression is stated.
        pointer: String,
        /// What is wrong.
        detail: String,
    },
    /// An external buffer that was not handed in.
    #[error(
        "the file \"{uri}\" is missing: it holds part of the model and has to be given with it"
    )]
    MissingFile {
        /// The buffer's URI.
        pointer: String,
        /// The percent-decoded URI.
        uri: String,
    },
    /// A buffer that has neither a URI nor the GLB binary chunk.
    #[error("the file states a buffer of {length} bytes but does not say where its data is")]
    MissingData {
        /// The buffer.
        pointer: String,
        /// Its stated length in bytes.
        length: u64,
    },
    /// A data URI that is not base64.
    #[error("embedded data is malformed: {detail}")]
    BadDataUri {
        /// The buffer's URI.
        pointer: String,
        /// What is wrong.
        detail: String,
    },
    /// More than this module is made for.
    #[error("the file is too large: {what} is {value}, and the limit is {limit}")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// Its value.
        value: u64,
        /// The largest value accepted.
        limit: u64,
        /// The property, where it is in the JSON text.
        pointer: Option<String>,
    },
    /// Positions were asked of an accessor that no primitive uses as `POSITION`, or triangles of a
    /// primitive that is not there.
    #[error("there are no vertex positions at {pointer}")]
    NotPositions {
        /// What was asked for.
        pointer: String,
    },
    /// New positions whose number is not the accessor's.
    #[error("{given} positions were given for {count} vertices")]
    WrongLength {
        /// The accessor.
        pointer: String,
        /// The number of positions given.
        given: usize,
        /// The accessor's number of elements.
        count: usize,
    },
    /// A new position for an element that cannot be changed.
    #[error(
        "vertex {element} cannot be moved: its data is shared with other data or not stored in the file"
    )]
    FixedElement {
        /// The accessor.
        pointer: String,
        /// The element of the accessor.
        element: usize,
    },
}

impl DocumentError {
    /// The stable, machine-readable name of the error, such as `document.truncated`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::BadContainer { .. } => "document.bad-container",
            Self::Truncated { .. } => "document.truncated",
            Self::VersionUnsupported { .. } => "document.version-unsupported",
            Self::BadJson { .. } => "document.bad-json",
            Self::BadIndex { .. } => "document.bad-index",
            Self::OutOfBounds { .. } => "document.out-of-bounds",
            Self::BadAccessor { .. } => "document.bad-accessor",
            Self::NonFinitePosition { .. } => "document.non-finite-position",
            Self::BadVertex { .. } => "document.bad-vertex",
            Self::PrimitiveRestart { .. } => "document.primitive-restart",
            Self::CyclicNodes { .. } => "document.cyclic-nodes",
            Self::ExtensionUnsupported { .. } => "document.extension-unsupported",
            Self::CompressionUnsupported { .. } => "document.compression-unsupported",
            Self::BadCompression { .. } => "document.bad-compression",
            Self::MissingFile { .. } => "document.missing-file",
            Self::MissingData { .. } => "document.missing-data",
            Self::BadDataUri { .. } => "document.bad-data-uri",
            Self::TooLarge { .. } => "document.too-large",
            Self::NotPositions { .. } => "document.not-positions",
            Self::WrongLength { .. } => "document.wrong-length",
            Self::FixedElement { .. } => "document.fixed-element",
        }
    }

    /// The JSON pointer (RFC 6901) of the property concerned, if the error is about one.
    pub fn pointer(&self) -> Option<&str> {
        match self {
            Self::BadContainer { .. } => None,
            Self::VersionUnsupported { .. } => Some("/asset/version"),
            Self::Truncated { pointer, .. }
            | Self::BadJson { pointer, .. }
            | Self::TooLarge { pointer, .. } => pointer.as_deref(),
            Self::BadIndex { pointer, .. }
            | Self::OutOfBounds { pointer, .. }
            | Self::BadAccessor { pointer, .. }
            | Self::NonFinitePosition { pointer, .. }
            | Self::BadVertex { pointer, .. }
            | Self::PrimitiveRestart { pointer, .. }
            | Self::CyclicNodes { pointer, .. }
            | Self::ExtensionUnsupported { pointer, .. }
            | Self::CompressionUnsupported { pointer, .. }
            | Self::BadCompression { pointer, .. }
            | Self::MissingFile { pointer, .. }
            | Self::MissingData { pointer, .. }
            | Self::BadDataUri { pointer, .. }
            | Self::NotPositions { pointer, .. }
            | Self::WrongLength { pointer, .. }
            | Self::FixedElement { pointer, .. } => Some(pointer),
        }
    }
}
