//! Pixels as a PNG file (W3C, third edition): eight bits a channel, each row by what it differs from the row above.

use miniz_oxide::deflate::compress_to_vec_zlib;

const SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];
/// Of the filters of rows: differences from the row above.
const UP: u8 = 2;
/// Of deflate, 0 to 10.
const EFFORT: u8 = 8;

/// The file of rows of pixels, `width` in each.
pub(super) fn png(width: u32, height: u32, pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut rows = Vec::with_capacity(pixels.len() * 3 + height as usize);
    let mut above = vec![[0u8; 3]; width as usize];
    for row in pixels.chunks_exact(width as usize) {
        rows.push(UP);
        for (pixel, above) in row.iter().zip(&above) {
            rows.extend((0..3).map(|c| pixel[c].wrapping_sub(above[c])));
        }
        above.copy_from_slice(row);
    }
    let mut header = Vec::new();
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    header.extend([8, 2, 0, 0, 0]); // eight bits, red green blue; the rest has one value each
    let mut file = SIGNATURE.to_vec();
    chunk(&mut file, b"IHDR", &header);
    chunk(&mut file, b"IDAT", &compress_to_vec_zlib(&rows, EFFORT));
    chunk(&mut file, b"IEND", &[]);
    file
}

/// Length, name, content, and the check of both.
fn chunk(file: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    file.extend((content.len() as u32).to_be_bytes());
    let first = file.len();
    file.extend(name);
    file.extend(content);
    let check = crc32(&file[first..]);
    file.extend(check.to_be_bytes());
}

/// The CRC of ISO 3309.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    };
    !bytes.iter().fold(!0, step)
}

#[cfg(test)]
mod tests {
    use super::{crc32, png};

    #[test]
    fn a_file_holds_its_rows() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
        let file = png(2, 2, &[[1, 2, 3], [4, 5, 6], [2, 2, 3], [4, 5, 7]]);
        let data = file.windows(4).position(|name| name == b"IDAT");
        let content = &file[data.map_or(0, |at| at + 4)..];
        let rows = miniz_oxide::inflate::decompress_to_vec_zlib(content);
        assert_eq!(
            rows.ok(),
            Some(vec![2, 1, 2, 3, 4, 5, 6, 2, 1, 0, 0, 0, 0, 1])
        );
    }
}
