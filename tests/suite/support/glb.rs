//! The container of binary glTF.

/// A GLB file of the given chunks.
pub fn glb(chunks: &[([u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut body = Vec::new();
    for (kind, data) in chunks {
        body.extend_from_slice(&(data.len() as u32).to_le_bytes());
        body.extend_from_slice(kind);
        body.extend_from_slice(data);
    }
    let mut file = b"glTF".to_vec();
    file.extend_from_slice(&2_u32.to_le_bytes());
    file.extend_from_slice(&(body.len() as u32 + 12).to_le_bytes());
    file.extend_from_slice(&body);
    file
}
