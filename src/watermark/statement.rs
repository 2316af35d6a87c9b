//! A statement: what was found in a suspect, as one HTML file that a person prints or sends. No script, nothing from the network.

use super::changes::changes;
use super::illustration::{self, Illustration};
use super::report::{Comparison, Extraction, Input, Shape, Verdict};
use super::trace::{Traced, Tracing};
use std::f64::consts::LN_10;
use std::fmt::Write;

/// A file that a statement is about.
#[derive(Clone, Debug)]
pub struct StatedFile {
    /// What it is to the reader: `Suspect`, `Original`.
    pub role: String,
    /// Its name.
    pub name: String,
    /// Its size in bytes.
    pub bytes: u64,
    /// SHA-256 of it, in hexadecimal digits.
    pub sha256: String,
}

/// What a ledger says beside numbers.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    /// What it calls some buyers, by their numbers.
    pub names: Vec<(u64, String)>,
    /// How many triangles the model had that the copies were made of, as [`StampReport`](super::StampReport) says; `None` where the ledger does not.
    pub triangles: Option<u64>,
}

/// What was found.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Finding<'a> {
    /// With the key alone, or with an expected payload.
    Reading(&'a Extraction),
    /// Whose copies are in it, and what the ledger says of who is named; with the original or a record a picture of the suspect laid on it.
    Tracing(&'a Tracing, &'a Ledger, Option<&'a Illustration>),
    /// With the original or a record; and a picture of the suspect laid on it.
    Comparison(&'a Comparison, Option<&'a Illustration>),
}

/// What a statement says beside the finding. Every word is shown as text, whatever is in it.
#[derive(Clone, Copy, Debug)]
pub struct Statement<'a> {
    /// What was found.
    pub finding: Finding<'a>,
    /// Whose key it was, as they call themselves.
    pub owner: Option<&'a str>,
    /// Of the key: [`Key::commitment`](crate::Key::commitment).
    pub commitment: &'a str,
    /// What was looked at, the suspect first.
    pub files: &'a [StatedFile],
    /// When it was looked at, as the caller puts it: nothing here knows the time.
    pub date: Option<&'a str>,
    /// Command lines that repeat it.
    pub commands: &'a [String],
}

/// Decimal digits of a chance beyond which none is told: the keyed function that all rests on has a key of 128 bits.
const MOST_DIGITS: u32 = 38;

impl Statement<'_> {
    /// The statement as a whole HTML document.
    pub fn html(&self) -> String {
        let (title, meaning) = (self.title(), self.meaning());
        let mut facts = String::new();
        let mut fact = |name: &str, value: &str| {
            let _ = writeln!(
                facts,
                "<tr><th>{}</th><td>{}</td></tr>",
                text(name),
                text(value)
            );
        };
        if let Some(owner) = self.owner {
            fact("Owner of the key", owner);
        }
        fact("Commitment to the key", self.commitment);
        for file in self.files {
            fact(&file.role, &file.name);
            fact("Its size", &format!("{} bytes", grouped(file.bytes)));
            fact("Its SHA-256", &file.sha256);
        }
        if let Some(date) = self.date {
            fact("Date given", date);
        }
        self.found(&mut fact);
        fact("Made by", concat!("meshmark ", env!("CARGO_PKG_VERSION")));
        let limits: String = self
            .limits()
            .into_iter()
            .map(|limit| format!("<li>{}</li>\n", text(limit)))
            .collect();
        let commands: Vec<String> = self.commands.iter().map(|line| text(line)).collect();
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n\
             <title>{plain_title}</title>\n<style>{STYLE}{}</style>\n<h1>{title}</h1>\n<p>{meaning}</p>\n{answer}{shape}\
             <section class=\"box\"><h2>What this does not prove</h2>\n<ul>\n{limits}</ul></section>\n\
             <h2>Facts</h2>\n<table>\n{facts}</table>\n\
             <section><h2>How to repeat it</h2>\n<p>Whoever has the key and the files gets the same answer, on any machine:</p>\n<pre>{}</pre></section>\n\
             <section><h2>When it was so</h2>\n<p>Nothing was sent anywhere, and nothing here proves a date. To show later that the suspect or this report existed today, hand its \
             SHA-256 to a timestamping service (RFC 3161) or to a notary; a timestamp of the marked model, taken when it was marked, shows more.</p></section>\n</html>\n",
            illustration::STYLE,
            commands.join("\n"),
            plain_title = escaped(title),
            title = text(title),
            meaning = text(&meaning),
            answer = self.answer(),
            shape = self.shape(),
        )
    }

    fn title(&self) -> &'static str {
        match self.finding {
            Finding::Reading(reading) => reading.sentence,
            Finding::Tracing(tracing, ..) => tracing.sentence,
            Finding::Comparison(comparison, _) => comparison.sentence,
        }
    }

    /// What the verdict means, with its bound in words.
    fn meaning(&self) -> String {
        match self.finding {
            Finding::Reading(reading) => match reading.verdict {
                Verdict::Found | Verdict::Present => holds_a_mark(reading.details().ln_p),
                _ => reading.reason.clone().unwrap_or_default(),
            },
            Finding::Tracing(tracing, ..) => match tracing.traced {
                Traced::Named => format!(
                    "Each copy below had a part in the suspect. Beside it is an upper bound of the chance that any of the {} in the ledger is \
                     named so without a part in it; nobody is named where that is above 1 in 10^9.",
                    match tracing.num_buyers {
                        1 => "1 buyer".to_owned(),
                        buyers => format!("{} buyers", grouped(buyers as u64)),
                    }
                ),
                Traced::Nobody => "The suspect was made from a model with a mark of this key. Too little of any one copy is left to say \
                                   whose it was, or it is a copy that the ledger does not have."
                    .to_owned(),
                _ => tracing.reading.reason.clone().unwrap_or_default(),
            },
            Finding::Comparison(comparison, _) => match comparison.verdict {
                Verdict::Found | Verdict::Present => holds_a_mark(comparison.ln_p()),
                Verdict::Partial => "What was read fits this key, but not so well that chance is excluded.".to_owned(),
                _ => "What was read agrees with this key no better than by chance.".to_owned(),
            },
        }
    }

    /// Who is named, as a table: what a reader looks for first.
    fn answer(&self) -> String {
        let Finding::Tracing(tracing, ledger, _) = self.finding else {
            return String::new();
        };
        if tracing.buyers.is_empty() {
            return String::new();
        }
        let mut rows = String::new();
        for buyer in &tracing.buyers {
            let mut names = ledger.names.iter();
            let name = names.find(|(number, _)| *number == buyer.number);
            let name = name.map_or("", |(_, name)| name);
            let _ = writeln!(
                rows,
                "<tr><td>{}</td><td>{}</td><td>{}</td></tr>",
                buyer.number,
                text(name),
                text(&chance(buyer.ln_p))
            );
        }
        format!(
            "<table class=\"named\">\n<thead><tr><th>Copy</th><th>Buyer in the ledger</th><th>Chance to be named without a part in it</th></tr></thead>\n\
             <tbody>\n{rows}</tbody></table>\n"
        )
    }

    /// Of a comparison: whether the shape is the original's, in words and in a picture.
    fn shape(&self) -> String {
        let (comparison, picture) = match self.finding {
            Finding::Comparison(comparison, picture) => (comparison, picture),
            Finding::Tracing(
                Tracing {
                    comparison: Some(comparison),
                    ..
                },
                _,
                picture,
            ) => (comparison, picture),
            _ => return String::new(),
        };
        let near = percent(comparison.near);
        let words = match (comparison.shape, comparison.motion) {
            (Shape::Same, _) => format!(
                "The shape is the original\u{2019}s. {near} of the suspect\u{2019}s surface lies on the original when it is moved there{}, and \
                 shows {} of it.",
                match (comparison.is_mirrored, comparison.is_bent) {
                    (true, true) => ", mirrored and bent",
                    (true, false) => " and mirrored",
                    (false, true) => " and bent",
                    (false, false) => "",
                },
                percent(comparison.covered),
            ),
            (Shape::Other, Some(_)) => format!(
                "It is another shape: moved to the likeliest place on the original, {near} of the suspect\u{2019}s surface lies there."
            ),
            (Shape::Other, None) => {
                "It is another shape: no way was found to lay the suspect on the original."
                    .to_owned()
            }
        };
        let figure = picture.map_or("", |picture| &picture.html);
        format!("<p>{}</p>\n{figure}", text(&words))
    }

    fn found(&self, fact: &mut impl FnMut(&str, &str)) {
        let input = match self.finding {
            Finding::Reading(reading) => {
                if let Some(tag) = &reading.tag {
                    fact("Tag that was read", tag);
                }
                if let Some(number) = reading.number {
                    fact("Number that was read", &number.to_string());
                }
                if let Some(piece) = &reading.found_in {
                    let name = piece.name.as_deref().unwrap_or("without a name");
                    let (parts, all) = (piece.parts, piece.of_parts);
                    fact(
                        "Where it was read",
                        &format!(
                            "In a piece of the suspect alone, {name}: {parts} of its {all} parts"
                        ),
                    );
                }
                reading.input
            }
            Finding::Tracing(tracing, ledger, picture) => {
                fact("Buyers in the ledger", &grouped(tracing.num_buyers as u64));
                fact("Ways of reading tested", &tracing.num_ways.to_string());
                fact(
                    "What was done to the copy",
                    &done_to_a_copy(tracing, ledger, picture),
                );
                tracing.reading.input
            }
            Finding::Comparison(comparison, picture) => {
                if let Some(tag) = &comparison.tag {
                    fact("Tag that was read", tag);
                }
                if let Some(number) = comparison.number {
                    fact("Number that was read", &number.to_string());
                }
                let changes = changes(comparison, picture.and_then(|picture| picture.triangles));
                if !changes.is_empty() {
                    fact("What was done to the copy", &changes.join("; "));
                }
                Input::Model
            }
        };
        if input == Input::Evidence {
            fact(
                "What was read",
                "Evidence that somebody measured, not the model itself",
            );
        }
    }

    fn limits(&self) -> Vec<&'static str> {
        let caution = match self.finding {
            Finding::Reading(reading) => reading.caution,
            Finding::Tracing(tracing, ..) => tracing.reading.caution,
            Finding::Comparison(..) => None,
        };
        let mut limits = Vec::from_iter(caution);
        let is_positive = match self.finding {
            Finding::Reading(reading) => {
                matches!(reading.verdict, Verdict::Found | Verdict::Present)
            }
            Finding::Tracing(tracing, ..) => {
                matches!(tracing.traced, Traced::Named | Traced::Nobody)
            }
            Finding::Comparison(comparison, _) => {
                matches!(comparison.verdict, Verdict::Found | Verdict::Present)
            }
        };
        if is_positive {
            limits.extend([
                "Who made the model first. Whoever has the model can add a mark of their own; what counts is whose mark is in the earlier file.",
                "That the key was in nobody else's hands. Whoever has it can mark any model.",
                "Who copied it, when, or whether they were allowed to.",
            ]);
        } else {
            limits.push("That the model is not the owner's. A mark can be destroyed, and copies of unmarked files hold none.");
        }
        if let Finding::Tracing(tracing, ..) = self.finding
            && tracing.traced == Traced::Named
        {
            limits.extend([
                "That a buyer gave it away: their copy may have been stolen from them.",
                "That the ledger is right. It says which number was whose; its keeper holds the key and can stamp any number.",
                "That nobody else had a part in it: a share that is too small is not seen.",
            ]);
        }
        let comparison = match self.finding {
            Finding::Comparison(comparison, _) => Some(comparison),
            Finding::Tracing(tracing, ..) => tracing.comparison.as_ref(),
            Finding::Reading(_) => None,
        };
        if let Some(comparison) = comparison {
            if is_positive {
                limits.push(
                    "Anything, if the original or the record was made after the suspect was seen: whoever holds the key can make an \
                     \u{201c}original\u{201d} that any model seems to be a copy of. Show that it is older.",
                );
            }
            if comparison.shape == Shape::Same {
                limits.push("That a likeness of shapes is a copy: two people may model or scan the same thing. It is the mark that tells a copy.");
            }
        }
        limits.push("More than the keyed function it rests on (SipHash-2-4 with keys of 128 bits), which is taken for random to who has no key.");
        limits
    }
}

/// What was done to a copy that leaked, as far as there is something to compare the suspect with.
fn done_to_a_copy(tracing: &Tracing, ledger: &Ledger, picture: Option<&Illustration>) -> String {
    let seen = picture.and_then(|picture| picture.triangles);
    let comparison = tracing.comparison.as_ref();
    let mut done = comparison.map_or(Vec::new(), |comparison| changes(comparison, seen));
    let is_compared = comparison.is_some_and(|own| own.shape == Shape::Same);
    let sold = ledger.triangles.filter(|all| *all > 0);
    // What was counted where the suspect lies on the original says more.
    if seen.is_none()
        && let (Some(own), Some(sold)) = (tracing.triangles, sold)
    {
        let share = percent(own as f64 / sold as f64);
        let (own, sold) = (grouped(own as u64), grouped(sold));
        done.push(format!(
            "the suspect has {own} triangles, {share} of the {sold} that the ledger gives for the model that was sold"
        ));
    }
    match (done.as_slice(), is_compared) {
        ([], true) => "Nothing that is seen on the original".to_owned(),
        ([], false) => "Not known: no original or record was at hand that the suspect lies on, and the ledger does not say how many triangles the model had".to_owned(),
        (done, true) => done.join("; "),
        (done, false) => format!("{}; more is not known without the original", done.join("; ")),
    }
}

fn holds_a_mark(ln_p: f64) -> String {
    format!(
        "The suspect holds a mark of this key. A model that was made without the key would be given this answer with a probability of {}.",
        chance(ln_p)
    )
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// A bound in words, and as a power of ten.
fn chance(ln_p: f64) -> String {
    let digits = (-ln_p / LN_10) as u32;
    if digits > MOST_DIGITS {
        return format!(
            "less than 1 in 10^{MOST_DIGITS} (a 1 with {MOST_DIGITS} zeros), beyond which nothing is told"
        );
    }
    let words = match digits {
        0..=5 => return format!("at most 1 in {}", grouped(10_u64.pow(digits))),
        6..=8 => "less than one in a million",
        9..=11 => "less than one in a billion",
        _ => "less than one in a million millions",
    };
    format!("{words}: at most 1 in 10^{digits} (a 1 with {digits} zeros)")
}

/// A number with its digits in threes, which no line is broken between.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push('\u{a0}');
        }
        grouped.push(digit);
    }
    grouped
}

/// Words as text of HTML: nothing in them is markup, and none turns the direction of what follows.
fn text(words: &str) -> String {
    format!("<bdi>{}</bdi>", escaped(words))
}

fn escaped(words: &str) -> String {
    let mut escaped = String::new();
    for character in words.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
                escaped.push('\u{fffd}');
            }
            control if control.is_control() => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:46rem;margin:2rem auto;padding:0 1rem;color:#111;background:#fff}\
    h1{font-size:1.6rem;line-height:1.25}h2{font-size:1.15rem;margin:1.6rem 0 .6rem}.box{border:2px solid #111;padding:.2rem 1rem;margin:1.2rem 0}\
    .box h2{margin-top:.6rem}h1,p,li,th,td,pre{overflow-wrap:anywhere}table{border-collapse:collapse;width:100%}\
    th{text-align:left;vertical-align:top}tr>th:first-child{width:12rem}.named th:first-child{width:5rem}\
    .named td:nth-child(2){font-weight:600}td{vertical-align:top}\
    th,td{border-bottom:1px solid #ccc;padding:.25rem .8rem .25rem 0}pre{white-space:pre-wrap;background:#f3f3f3;padding:.8rem}\
    @page{margin:18mm}@media print{body{font-size:11pt;margin:0;padding:0;max-width:none}pre{border:1px solid #ccc}\
    .box,section,tr,pre{break-inside:avoid}h1,h2,thead{break-after:avoid}}";

#[cfg(test)]
mod tests {
    use super::{chance, text};

    #[test]
    fn words_are_text_whatever_is_in_them() {
        assert_eq!(
            text("<img src=x onerror=\"a()\">&'"),
            "<bdi>&lt;img src=x onerror=&quot;a()&quot;&gt;&amp;&#39;</bdi>"
        );
        assert_eq!(
            text("a\u{202e}b\u{0}\nc"),
            "<bdi>a\u{fffd}b\u{fffd}\u{fffd}c</bdi>"
        );
    }

    #[test]
    fn chances_are_never_smaller_than_the_bound() {
        assert_eq!(
            chance(-20.8),
            "less than one in a billion: at most 1 in 10^9 (a 1 with 9 zeros)"
        );
        assert_eq!(
            chance(-14.0),
            "less than one in a million: at most 1 in 10^6 (a 1 with 6 zeros)"
        );
        assert_eq!(
            chance(-3489.0),
            "less than 1 in 10^38 (a 1 with 38 zeros), beyond which nothing is told"
        );
        assert_eq!(chance(0.0), "at most 1 in 1");
        assert_eq!(chance(-11.6), "at most 1 in 100\u{a0}000");
    }
}
