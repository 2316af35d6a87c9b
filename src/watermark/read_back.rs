//! Whether a mark can be read.

use super::Error;
use super::judge::Judge;
use super::report::{Extraction, Input, Verdict};
use crate::bits::Payload;
use crate::carrier::Carrier;
use crate::key::Key;
use crate::mesh::Mesh;
use crate::progress::Progress;

/// Whether what was embedded is what was read: a payload, or that there is a mark.
pub(super) fn is_read(found: &Extraction, payload: Option<Payload>) -> bool {
    match payload {
        Some(payload) => found.number == Some(payload.number()),
        None => found.verdict == Verdict::Present,
    }
}

/// Whether a mark shows in a mesh as it is.
pub(super) fn is_seen_at_once(
    mesh: &Mesh,
    key: &Key,
    payload: Option<Payload>,
    progress: &mut dyn Progress,
) -> Result<bool, Error> {
    let mut readings = Carrier::STANDARD.map(|_| Default::default());
    for carrier in Carrier::STANDARD {
        readings[carrier as usize] = carrier.read_at_once(mesh, key, progress)?;
    }
    let read = Judge::new(key, None, Input::Model).conclude(&readings);
    Ok(is_read(&read, payload))
}
