//! Values of a JSON text, borrowed from it, that know their place.
//!
//! Objects are taken apart one level at a time. Compared with types that derive `Deserialize`, an
//! error can point to the very property that is wrong, and the WebAssembly module is smaller.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::DocumentError;

/// The place of a value, written as a JSON pointer (RFC 6901).
#[derive(Clone, Copy)]
pub(super) enum Place<'p> {
    Root,
    Field(&'p Place<'p>, &'p str),
    Item(&'p Place<'p>, usize),
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Root => Ok(()),
            Self::Field(parent, name) => write!(formatter, "{parent}/{}", escaped(name)),
            Self::Item(parent, index) => write!(formatter, "{parent}/{index}"),
        }
    }
}

/// A name as a JSON pointer spells it.
pub(super) fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

/// What can be read from a JSON value.
pub(super) trait FromJson<'a>: Sized {
    /// Reads the value `raw`, which stands at `place`.
    fn from_json(raw: &'a RawValue, place: Place) -> Result<Self, DocumentError>;
}

/// The members of an object. Of members with the same name, the last counts, as everywhere on the web.
pub(super) struct Object<'a, 'p> {
    members: BTreeMap<String, &'a RawValue>,
    place: Place<'p>,
}

impl<'a, 'p> Object<'a, 'p> {
    pub fn new(raw: &'a RawValue, place: Place<'p>) -> Result<Self, DocumentError> {
        Ok(Self {
            members: parse(raw, place)?,
            place,
        })
    }

    /// The whole text, an object.
    pub fn root(text: &'a str) -> Result<Self, DocumentError> {
        let members = serde_json::from_str(text).map_err(|error| DocumentError::BadJson {
            detail: error.to_string(),
            pointer: None,
        })?;
        Ok(Self {
            members,
            place: Place::Root,
        })
    }

    /// A member, if it is there. `null`, which no member of glTF may be, is what some exporters write for what is not.
    // Not inlined, for the sake of the WebAssembly module's size: there are some fifty calls.
    #[inline(never)]
    fn member(&self, name: &str) -> Option<&'a RawValue> {
        let member = self.members.get(name).copied();
        member.filter(|raw| raw.get() != "null")
    }

    /// A member that may be absent.
    pub fn optional<T: FromJson<'a>>(&self, name: &str) -> Result<Option<T>, DocumentError> {
        match self.member(name) {
            Some(raw) => Ok(Some(T::from_json(raw, Place::Field(&self.place, name))?)),
            None => Ok(None),
        }
    }

    /// A member that must be there.
    pub fn required<T: FromJson<'a>>(&self, name: &str) -> Result<T, DocumentError> {
        self.optional(name)?.ok_or_else(|| self.missing(name))
    }

    /// A member that has a default.
    pub fn or_default<T: FromJson<'a> + Default>(&self, name: &str) -> Result<T, DocumentError> {
        Ok(self.optional(name)?.unwrap_or_default())
    }

    /// A list that may be absent and has no more than `limit` items, which are counted before any of them is read.
    pub fn at_most<T: FromJson<'a>>(
        &self,
        name: &str,
        limit: usize,
        what: &'static str,
    ) -> Result<Vec<T>, DocumentError> {
        let count = self.or_default::<Vec<&RawValue>>(name)?.len();
        if count > limit {
            return Err(DocumentError::TooLarge {
                what,
                value: count as u64,
                limit: limit as u64,
                pointer: Some(Place::Field(&self.place, name).to_string()),
            });
        }
        self.or_default(name)
    }

    fn missing(&self, name: &str) -> DocumentError {
        DocumentError::BadJson {
            detail: format!("\"{name}\" is missing"),
            pointer: Some(self.place.to_string()),
        }
    }
}

/// Parses a value of a text that is known to be well-formed.
fn parse<'a, T: Deserialize<'a>>(raw: &'a RawValue, place: Place) -> Result<T, DocumentError> {
    serde_json::from_str(raw.get()).map_err(|error| {
        // The parser's position counts from the start of the value; the pointer says it better.
        let message = error.to_string();
        let detail = message
            .rsplit_once(" at line ")
            .map_or(&*message, |(detail, _)| detail);
        wrong(detail, place)
    })
}

/// The error of a value that is not what it should be.
pub(super) fn wrong(detail: &str, place: Place) -> DocumentError {
    DocumentError::BadJson {
        detail: detail.to_owned(),
        pointer: Some(place.to_string()),
    }
}

impl<'a> FromJson<'a> for &'a RawValue {
    fn from_json(raw: &'a RawValue, _: Place) -> Result<Self, DocumentError> {
        Ok(raw)
    }
}

impl FromJson<'_> for u64 {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        raw.get()
            .parse()
            .map_err(|_| wrong("a whole number is expected that is not negative", place))
    }
}

impl FromJson<'_> for bool {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        raw.get()
            .parse()
            .map_err(|_| wrong("true or false is expected", place))
    }
}

impl FromJson<'_> for f64 {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        parse(raw, place)
    }
}

impl FromJson<'_> for String {
    fn from_json(raw: &RawValue, place: Place) -> Result<Self, DocumentError> {
        parse(raw, place)
    }
}

impl<'a, T: FromJson<'a>> FromJson<'a> for Vec<T> {
    fn from_json(raw: &'a RawValue, place: Place) -> Result<Self, DocumentError> {
        // A loop, since collecting results would have two copies of what reads an item.
        let raws: Vec<&RawValue> = parse(raw, place)?;
        let mut items = Self::with_capacity(raws.len());
        for (index, item) in raws.into_iter().enumerate() {
            items.push(T::from_json(item, Place::Item(&place, index))?);
        }
        Ok(items)
    }
}

impl<'a, T: FromJson<'a>, const N: usize> FromJson<'a> for [T; N] {
    fn from_json(raw: &'a RawValue, place: Place) -> Result<Self, DocumentError> {
        let items = Vec::from_json(raw, place)?;
        items
            .try_into()
            .map_err(|_| wrong(&format!("a list of {N} is expected"), place))
    }
}

impl<'a, T: FromJson<'a>> FromJson<'a> for BTreeMap<String, T> {
    fn from_json(raw: &'a RawValue, place: Place) -> Result<Self, DocumentError> {
        // Insertion, since collecting would sort what is sorted.
        let mut map = Self::new();
        for (name, raw) in Object::new(raw, place)?.members {
            let value = T::from_json(raw, Place::Field(&place, &name))?;
            map.insert(name, value);
        }
        Ok(map)
    }
}

/// Where in `text` the value `part`, which was borrowed from it, stands.
pub(super) fn span(text: &str, part: &str) -> Option<Range<usize>> {
    let start = part.as_ptr().addr().checked_sub(text.as_ptr().addr())?;
    let end = start.checked_add(part.len())?;
    text.get(start..end).is_some().then_some(start..end)
}
