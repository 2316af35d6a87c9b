//! What kind of file somebody brought, by its content: names of files say little.

use crate::failure::Failure;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use std::io::{Read, Write};
use std::path::Path;

/// The most bytes that a file wrapped by gzip may unfold to: a small one could ask for all the memory there is.
const MAX_UNFOLDED: u64 = 1 << 31;

/// A kind of file that is read here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// .glb, .gltf, .vrm
    Gltf,
    /// .obj, text
    Obj,
    /// .stl, text or binary
    Stl,
    /// .ply, text or binary
    Ply,
}

/// What a model file is wrapped in; a changed model is wrapped in the same.
pub enum Wrapping {
    Nothing,
    /// .gz
    Gzip,
    /// A batched tile (.b3dm): what stands before its .glb.
    Tile(Vec<u8>),
}

/// The bytes in a file, and what they were wrapped in.
pub fn unwrap(path: &Path, bytes: Vec<u8>) -> Result<(Vec<u8>, Wrapping), Failure> {
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut content = Vec::new();
        let mut reader = GzDecoder::new(&*bytes).take(MAX_UNFOLDED + 1);
        reader
            .read_to_end(&mut content)
            .map_err(|error| Failure::file(path, error))?;
        if content.len() as u64 > MAX_UNFOLDED {
            let words = format!("{} unfolds to more than 2 GiB", path.display());
            return Err(Failure::Words(words));
        }
        return Ok((content, Wrapping::Gzip));
    }
    let before = tile_tables(&bytes).filter(|&before| bytes[before..].starts_with(b"glTF"));
    Ok(match before {
        Some(before) => (
            bytes[before..].to_vec(),
            Wrapping::Tile(bytes[..before].to_vec()),
        ),
        None => (bytes, Wrapping::Nothing),
    })
}

/// How many bytes of a batched tile stand before its .glb.
fn tile_tables(bytes: &[u8]) -> Option<usize> {
    let word = |place: usize| Some(u32::from_le_bytes(*bytes.get(place..)?.first_chunk()?));
    if !bytes.starts_with(b"b3dm") {
        return None;
    }
    let mut before = 28_u64;
    for place in [12, 16, 20, 24] {
        before += u64::from(word(place)?);
    }
    usize::try_from(before)
        .ok()
        .filter(|&before| before < bytes.len())
}

impl Wrapping {
    /// Wraps a model again.
    pub fn wrap(&self, model: &[u8]) -> std::io::Result<Vec<u8>> {
        match self {
            Wrapping::Nothing => Ok(model.to_vec()),
            Wrapping::Gzip => {
                let mut writer = GzEncoder::new(Vec::new(), Compression::best());
                writer.write_all(model)?;
                writer.finish()
            }
            Wrapping::Tile(before) => {
                let mut tile = [before, model].concat();
                // Tiles end at multiples of eight bytes.
                tile.resize(tile.len().next_multiple_of(8), 0);
                let length = u32::try_from(tile.len()).map_err(std::io::Error::other)?;
                tile[8..12].copy_from_slice(&length.to_le_bytes());
                Ok(tile)
            }
        }
    }
}

/// The kind of a file.
pub fn recognize(path: &Path, bytes: &[u8]) -> Result<Format, Failure> {
    if is_gltf(bytes) {
        Ok(Format::Gltf)
    } else if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        Ok(Format::Ply)
    } else if is_stl(bytes) {
        Ok(Format::Stl)
    } else if let Some((kind, advice)) = other_kind(bytes) {
        Err(Failure::OtherFormat {
            path: path.to_owned(),
            kind,
            advice,
        })
    } else if is_obj(bytes) {
        Ok(Format::Obj)
    } else {
        // The library says what is wrong with it as glTF.
        Ok(Format::Gltf)
    }
}

/// What helps with a model of a kind that is not read, with an archive, and with what is no model.
const READABLE: &str = "convert it to .glb, .obj, .stl or .ply, for example with Blender; or check it in the page, which reads more formats";
const PACKED: &str = "unpack it, and name the model in it";
const NO_MODEL: &str = "it has no surface that could be looked at";

impl Format {
    /// What helps where a glTF model is needed.
    pub fn refused(self, path: &Path) -> Failure {
        let kind = match self {
            Format::Gltf => "glTF",
            Format::Obj => "an OBJ file",
            Format::Stl => "an STL file",
            Format::Ply => "a PLY file",
        };
        Failure::OtherFormat {
            path: path.to_owned(),
            kind,
            advice: "it can be checked, but a mark is written into glTF only: convert it to .glb, for example with Blender",
        }
    }
}

fn is_gltf(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    bytes.starts_with(b"glTF") || text.trim_ascii_start().starts_with(b"{")
}

/// Binary files have no mark of their own but a length that fits; some of them begin as text files do.
fn is_stl(bytes: &[u8]) -> bool {
    is_binary_stl(bytes)
        || begins(bytes, b"solid")
            && head(bytes)
                .windows(5)
                .any(|word| word.eq_ignore_ascii_case(b"facet"))
}

/// Whether the number of triangles that a binary STL file states is the number that it has room for.
pub fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.first_chunk());
    count.is_some_and(|count| {
        let count = u64::from(u32::from_le_bytes(*count));
        count > 0 && bytes.len() as u64 == 84 + 50 * count
    })
}

/// Whether the first line that says something is one of an OBJ file's.
fn is_obj(bytes: &[u8]) -> bool {
    const WORDS: [&[u8]; 13] = [
        b"v", b"vt", b"vn", b"vp", b"f", b"o", b"g", b"s", b"l", b"p", b"mtllib", b"usemtl",
        b"cstype",
    ];
    let lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut said = lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    let first = said
        .next()
        .and_then(|line| line.split(u8::is_ascii_whitespace).next());
    first.is_some_and(|word| WORDS.contains(&word))
}

fn begins(bytes: &[u8], word: &[u8]) -> bool {
    let text = bytes.trim_ascii_start();
    text.get(..word.len())
        .is_some_and(|start| start.eq_ignore_ascii_case(word))
}

/// The first 4 KiB.
fn head(bytes: &[u8]) -> &[u8] {
    &bytes[..bytes.len().min(4096)]
}

/// A kind that is known and not read, and what helps.
fn other_kind(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let has = |word: &[u8]| head(bytes).windows(word.len()).any(|window| window == word);
    let starts = |words: &[&[u8]]| words.iter().any(|word| bytes.starts_with(word));
    let is_zip = starts(&[b"PK\x03\x04"]);
    let kinds = [
        (is_zip && has(b"3D/"), "a 3MF file", READABLE),
        (
            is_zip && (has(b".usd") || has(b".USD")),
            "a USDZ file",
            READABLE,
        ),
        (is_zip, "a .zip archive", PACKED),
        (starts(&[b"Rar!", b"7z\xbc\xaf"]), "an archive", PACKED),
        (
            starts(&[b"Kaydara FBX Binary"]) || has(b"; FBX "),
            "an FBX file",
            READABLE,
        ),
        (has(b"<COLLADA"), "a COLLADA file (.dae)", READABLE),
        (starts(&[b"PXR-USDC", b"#usda"]), "a USD file", READABLE),
        (
            starts(&[b"BLENDER", b"\x28\xb5\x2f\xfd"]),
            "a Blender file",
            READABLE,
        ),
        (starts(&[b"ISO-10303-21"]), "a STEP or IFC file", READABLE),
        (starts(&[b"DRACO"]), "a bare Draco file (.drc)", READABLE),
        (begins(bytes, b"OFF"), "an OFF file", READABLE),
        (
            starts(&[b"#VRML"]) || has(b"<X3D"),
            "a VRML or X3D file",
            READABLE,
        ),
        (has(b"<amf"), "an AMF file", READABLE),
        (
            starts(&[b"MM"]) && bytes.get(6..8) == Some(&[2, 0]),
            "a 3DS file",
            READABLE,
        ),
        (
            starts(&[b"i3dm", b"cmpt"]),
            "a tile of instances or of other tiles",
            READABLE,
        ),
        (starts(&[b"pnts", b"LASF"]), "a point cloud", NO_MODEL),
        (
            starts(&[b"\x89PNG", b"\xff\xd8\xff", b"RIFF", b"GIF8"]),
            "a picture, a sound or a film",
            NO_MODEL,
        ),
        (starts(&[b"%PDF"]), "a PDF file", NO_MODEL),
        (
            begins(bytes, b"<!doctype html") || begins(bytes, b"<html"),
            "a web page",
            NO_MODEL,
        ),
    ];
    let mut known = kinds.into_iter().filter(|(is_it, ..)| *is_it);
    known.next().map(|(_, kind, advice)| (kind, advice))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;

    #[test]
    fn kinds_are_known_by_their_content() {
        let known = |bytes: &[u8]| {
            recognize(Path::new("a.glb"), bytes).map_err(|failure| failure.to_string())
        };
        assert_eq!(known(b"glTF\x02"), Ok(Format::Gltf));
        assert_eq!(known("\u{feff} {}".as_bytes()), Ok(Format::Gltf));
        assert_eq!(known(b"ply\r\nformat"), Ok(Format::Ply));
        assert_eq!(known(b"solid a\n facet normal"), Ok(Format::Stl));
        assert_eq!(known(b"# Blender\n\nmtllib a.mtl\n"), Ok(Format::Obj));
        assert_eq!(known(b"who knows"), Ok(Format::Gltf));
        for (bytes, kind) in [
            (&b"Kaydara FBX Binary  \0"[..], "an FBX file; convert"),
            (b"PK\x03\x04....3D/3dmodel.model", "a 3MF file; convert"),
            (b"PK\x03\x04....scene.gltf", "a .zip archive; unpack"),
            (
                b"\x89PNG\r\n",
                "a picture, a sound or a film; it has no surface",
            ),
        ] {
            let message = known(bytes).unwrap_err();
            assert!(message.contains(kind), "{message}");
        }
    }

    #[test]
    fn wrappings_are_taken_off_and_put_on_again() {
        let model = b"glTF and more".to_vec();
        let mut tile = b"b3dm\x01\0\0\0....\x04\0\0\0\0\0\0\0\x03\0\0\0\0\0\0\0fea bat".to_vec();
        tile.extend(&model);
        tile.resize(tile.len().next_multiple_of(8), 0);
        let length = tile.len() as u32;
        tile[8..12].copy_from_slice(&length.to_le_bytes());
        for wrapped in [Wrapping::Gzip.wrap(&model).unwrap(), tile] {
            let (content, wrapping) = unwrap(Path::new("a"), wrapped.clone()).unwrap();
            assert!(content.starts_with(&model));
            assert_eq!(wrapping.wrap(&content).unwrap(), wrapped);
        }
        let (content, wrapping) = unwrap(Path::new("a"), model.clone()).unwrap();
        assert_eq!(wrapping.wrap(&content).unwrap(), model);
        assert!(unwrap(Path::new("a"), vec![0x1f, 0x8b, 8]).is_err());
    }
}
