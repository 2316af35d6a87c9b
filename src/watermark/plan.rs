//! A plan as bytes: docs/FORMAT.md, "Plans". All integers and numbers little-endian.

use super::copies::{Plan, Stored};
use super::displace::Used;
use super::error::{PLAN_VERSION, PlanError};
use super::marking::Recipe;
use super::{EmbedOptions, Error, Strength};
use crate::carrier::{Carrier, Choice, Chosen};
use crate::document::Files;
use crate::key::Key;

const MAGIC: &[u8; 4] = b"MMPL";

impl Plan {
    /// The plan as bytes: the host, the key, and what was chosen for it. Whoever has them can make copies and read every copy: keep them as
    /// you keep the key.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Stored {
            host,
            files,
            key,
            options,
            recipe,
            ln_p,
        } = &self.stored;
        let mut out = Vec::with_capacity(host.len() + 1024);
        out.extend(MAGIC);
        out.extend(PLAN_VERSION.to_le_bytes());
        out.extend(key.to_bytes().as_slice());
        let strength = options.strength;
        out.extend(strength.rms_rel().to_le_bytes());
        out.push(u8::from(strength.is_hidden()));
        out.extend(options.max_movement.unwrap_or(0.0).to_le_bytes());
        let carriers = options.carriers.iter();
        out.push(carriers.fold(0, |bits, &carrier| bits | 1 << carrier as u8));
        out.extend(ln_p.to_le_bytes());
        write_used(&recipe.shown, &mut out);
        write_count(recipe.unshown.len(), &mut out);
        for (mesh, used) in &recipe.unshown {
            write_count(*mesh, &mut out);
            write_used(used, &mut out);
        }
        write_count(files.len(), &mut out);
        for (name, content) in files {
            write_block(name.as_bytes(), &mut out);
            write_block(content, &mut out);
        }
        write_block(host, &mut out);
        out
    }

    /// A plan from its bytes. It looks at the host again, as [`prepare`](super::prepare) does, but searches for nothing.
    ///
    /// # Errors
    /// [`Error::Plan`] where they are something else, of another version or damaged; whatever keeps the host from being read.
    pub fn from_bytes(bytes: &[u8]) -> Result<Plan, Error> {
        let bytes = bytes.strip_prefix(MAGIC).ok_or(PlanError::NotPlan)?;
        let mut bytes = Reader(bytes);
        match u16::from_le_bytes(bytes.take()?) {
            PLAN_VERSION => {}
            other => return Err(PlanError::Version(other).into()),
        }
        let stored = read(&mut bytes)?;
        if !bytes.0.is_empty() {
            return Err(PlanError::Damaged.into());
        }
        Plan::of(stored)
    }
}

fn read(bytes: &mut Reader) -> Result<Stored, Error> {
    let key = Key::from_bytes(&bytes.take::<{ Key::BYTES }>()?)?;
    let rms_rel = bytes.number()?;
    let is_hidden = bytes.take::<1>()? != [0];
    let max_movement = bytes.number()?;
    let [carriers] = bytes.take()?;
    let options = EmbedOptions {
        strength: Strength::stored(rms_rel, is_hidden)?,
        carriers: (Carrier::ALL.into_iter())
            .filter(|&carrier| carriers >> carrier as u8 & 1 == 1)
            .collect(),
        max_movement: (max_movement != 0.0).then_some(max_movement),
    };
    let ln_p = bytes.number()?;
    let shown = bytes.used()?;
    let mut unshown = Vec::new();
    for _ in 0..bytes.count()? {
        unshown.push((bytes.count()?, bytes.used()?));
    }
    let mut files = Files::new();
    for _ in 0..bytes.count()? {
        let name = String::from_utf8(bytes.block()?.to_vec());
        let name = name.map_err(|_| PlanError::Damaged)?;
        files.insert(name, bytes.block()?.to_vec());
    }
    Ok(Stored {
        host: bytes.block()?.to_vec(),
        files,
        key,
        options,
        recipe: Recipe { shown, unshown },
        ln_p,
    })
}

/// Objects that stand for the whole.
const WHOLE: u32 = u32::MAX;

fn write_used(used: &[Used], out: &mut Vec<u8>) {
    write_count(used.len(), out);
    for Used { carrier, chosen } in used {
        out.push(*carrier as u8);
        write_count(chosen.len(), out);
        for Chosen { object, choice } in chosen {
            out.extend(object.unwrap_or(WHOLE).to_le_bytes());
            let numbers = [
                choice.pitch,
                choice.step,
                choice.clamp,
                choice.limit,
                choice.ridge,
            ];
            out.extend(numbers.into_iter().flat_map(f64::to_le_bytes));
        }
    }
}

/// Files and models have fewer than 2^32 bytes: glTF's own limit.
fn write_count(count: usize, out: &mut Vec<u8>) {
    out.extend((count as u32).to_le_bytes());
}

fn write_block(block: &[u8], out: &mut Vec<u8>) {
    write_count(block.len(), out);
    out.extend(block);
}

/// What is left of some bytes.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], PlanError> {
        let (first, rest) = self.0.split_first_chunk().ok_or(PlanError::Damaged)?;
        self.0 = rest;
        Ok(*first)
    }

    fn count(&mut self) -> Result<usize, PlanError> {
        Ok(u32::from_le_bytes(self.take()?) as usize)
    }

    /// A finite number.
    fn number(&mut self) -> Result<f64, PlanError> {
        let number = f64::from_le_bytes(self.take()?);
        number
            .is_finite()
            .then_some(number)
            .ok_or(PlanError::Damaged)
    }

    fn block(&mut self) -> Result<&'a [u8], PlanError> {
        let length = self.count()?;
        let (block, rest) = self.0.split_at_checked(length).ok_or(PlanError::Damaged)?;
        self.0 = rest;
        Ok(block)
    }

    fn used(&mut self) -> Result<Vec<Used>, PlanError> {
        let mut used = Vec::new();
        for _ in 0..self.count()? {
            let [carrier] = self.take()?;
            let carrier = Carrier::ALL.into_iter().find(|one| *one as u8 == carrier);
            let mut chosen = Vec::new();
            let carrier = carrier.ok_or(PlanError::Damaged)?;
            for _ in 0..self.count()? {
                let object = u32::from_le_bytes(self.take()?);
                let mut positive = || {
                    let number = self.number()?;
                    (number > 0.0).then_some(number).ok_or(PlanError::Damaged)
                };
                let choice = Choice {
                    pitch: positive()?,
                    step: positive()?,
                    clamp: positive()?,
                    limit: positive()?,
                    ridge: positive()?,
                };
                if !choice.is_possible() {
                    return Err(PlanError::Damaged);
                }
                chosen.push(Chosen {
                    object: (object != WHOLE).then_some(object),
                    choice,
                });
            }
            used.push(Used { carrier, chosen });
        }
        Ok(used)
    }
}
