//! Of all ways of reading with the original, or with a record, those that are worth testing for buyers: of each way to look at the suspect
//! the one in which the pilots speak loudest.

use super::testimony::Testimony;
use crate::carrier::{Place, Way};
use crate::code::Symbol;
use crate::detection::{LN_P_FOUND, ln_p_of_errors};

/// Ways to look at a suspect that lies on its original: its surface, and the vertices that it kept.
const VIEWS: usize = 2;

/// The loudest way of each view of all that were heard.
#[derive(Default)]
pub(super) struct Loudest([Option<Voice>; VIEWS]);

struct Voice {
    ln_p_pilots: f64,
    places: Vec<Place>,
}

impl Loudest {
    /// Hears a way of reading.
    pub fn hear(&mut self, way: Way) {
        let pilots = way.places.iter();
        let pilots = pilots.filter(|place| place.symbol == Symbol::Pilot);
        let ln_p_pilots = ln_p_of_errors(pilots.map(|place| (place.response, place.errors[1])));
        let loudest = &mut self.0[way.list % VIEWS];
        if loudest
            .as_ref()
            .is_none_or(|loudest| ln_p_pilots < loudest.ln_p_pilots)
        {
            *loudest = Some(Voice {
                ln_p_pilots,
                places: way.places,
            });
        }
    }

    /// Whether they speak so loudly that the suspect need not be laid on the original in other ways.
    pub fn are_loud(&self) -> bool {
        let mut all = self.0.iter().flatten();
        all.any(|voice| voice.ln_p_pilots <= 2.0 * LN_P_FOUND)
    }

    /// What they say, the loudest first.
    pub fn testimonies(&self) -> Vec<Testimony> {
        let mut all: Vec<&Voice> = self.0.iter().flatten().collect();
        all.sort_by(|a, b| a.ln_p_pilots.total_cmp(&b.ln_p_pilots));
        let all = all.into_iter();
        all.filter_map(|voice| Testimony::of_places(&voice.places))
            .collect()
    }
}
