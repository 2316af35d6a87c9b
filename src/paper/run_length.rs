//! Bits as runs of alternating symbols, which show where a symbol was lost or came in between: section III.B of Vasic 2012
//! (docs/REFERENCES.md), and its exact decoder.
//!
//! A 0 is a run of two, a 1 a run of three; the first run is of ones, the second of zeros, and so on.

/// Symbols that the longest run may arrive with.
const LONGEST: usize = 7;

/// Evidence of a symbol is cut off here, so that no product of a run's likelihoods vanishes.
const MOST: f64 = 30.0;

/// What happens to runs on their way: every symbol is lost with one probability, or else arrives, followed by `n` copies of
/// itself with probability `(1 - insertion) insertion^n`. Runs of more than seven symbols are left out of account.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Probability of another copy, 0 to 1.
    pub insertion: f64,
    /// Probability that a symbol is lost, 0 to 1.
    pub deletion: f64,
}

/// The symbols of bits: 2 to 3 for each.
pub fn encode(bits: &[bool]) -> Vec<bool> {
    let run = |(place, &bit): (usize, &bool)| std::iter::repeat_n(level(place), length(bit));
    bits.iter().enumerate().flat_map(run).collect()
}

/// The symbol of the run in a place.
fn level(place: usize) -> bool {
    place.is_multiple_of(2)
}

fn length(bit: bool) -> usize {
    if bit { 3 } else { 2 }
}

/// Evidence `ln P(0) / P(1)` of each of `num_bits` bits, from the same of R received symbols: what all ways of cutting the
/// symbols into runs say together, by the forward-backward algorithm over (bits sent, symbols received). Symbols after the last
/// run say nothing. Bits of equal probability are assumed; all evidence is 0 where the symbols cannot be cut at all.
/// O(num_bits * R).
pub fn decode(symbols: &[f64], num_bits: usize, channel: Channel) -> Vec<f64> {
    let trellis = Trellis::new(symbols, channel);
    let ends = symbols.len() + 1;
    let mut forward = vec![vec![0.0; ends]];
    forward[0][0] = 1.0;
    for place in 0..num_bits {
        let mut next = vec![0.0; ends];
        for (from, &weight) in forward[place].iter().enumerate() {
            if weight > 0.0 {
                for (to, emission) in trellis.runs(place, from) {
                    let [zero, one] = trellis.lengths[to - from];
                    next[to] += weight * emission * (zero + one);
                }
            }
        }
        scale(&mut next);
        forward.push(next);
    }
    let mut evidence = vec![0.0; num_bits];
    let mut backward = vec![1.0; ends];
    for place in (0..num_bits).rev() {
        let mut before = vec![0.0; ends];
        let mut totals = [0.0; 2];
        for (from, before) in before.iter_mut().enumerate() {
            for (to, emission) in trellis.runs(place, from) {
                let rest = emission * backward[to];
                let [zero, one] = trellis.lengths[to - from];
                *before += rest * (zero + one);
                totals[0] += forward[place][from] * rest * zero;
                totals[1] += forward[place][from] * rest * one;
            }
        }
        evidence[place] = ratio(totals);
        scale(&mut before);
        backward = before;
    }
    evidence
}

/// `ln (a / b)`; 0 where both vanish.
fn ratio([a, b]: [f64; 2]) -> f64 {
    if a == b {
        return 0.0;
    }
    (libm::log(a) - libm::log(b)).clamp(-MOST, MOST)
}

/// Brings the greatest weight to 1: only ratios count.
fn scale(weights: &mut [f64]) {
    let most = weights.iter().copied().fold(0.0, f64::max);
    if most > 0.0 {
        weights.iter_mut().for_each(|weight| *weight /= most);
    }
}

struct Trellis {
    /// Likelihood of each received symbol as a 0 and as a 1, in units of that of a symbol that says nothing.
    likelihoods: Vec<[f64; 2]>,
    /// Probability that the run of a 0 and of a 1 arrives with so many symbols.
    lengths: [[f64; 2]; LONGEST + 1],
}

impl Trellis {
    fn new(symbols: &[f64], channel: Channel) -> Trellis {
        let likelihood = |&value: &f64| {
            let value = if value.is_nan() { 0.0 } else { value };
            let odds = libm::exp(value.clamp(-MOST, MOST));
            [2.0 * odds / (1.0 + odds), 2.0 / (1.0 + odds)]
        };
        let [zero, one] = [false, true].map(|bit| arrivals(length(bit), channel));
        Trellis {
            likelihoods: symbols.iter().map(likelihood).collect(),
            lengths: std::array::from_fn(|n| [zero[n], one[n]]),
        }
    }

    /// Where the run in a place may end if it begins at a received symbol, and the likelihood of the symbols between.
    fn runs(&self, place: usize, from: usize) -> impl Iterator<Item = (usize, f64)> {
        let level = usize::from(level(place));
        let symbols = self.likelihoods[from..].iter().take(LONGEST);
        let products = symbols.scan(1.0, move |product, likelihood| {
            *product *= likelihood[level];
            Some(*product)
        });
        (from..).zip(std::iter::once(1.0).chain(products))
    }
}

/// Probabilities that a run of `sent` symbols arrives with 0, 1, ... symbols.
fn arrivals(sent: usize, channel: Channel) -> [f64; LONGEST + 1] {
    let Channel {
        insertion,
        deletion,
    } = channel;
    let mut run = [0.0; LONGEST + 1];
    run[0] = 1.0;
    for _ in 0..sent {
        let mut longer = [0.0; LONGEST + 1];
        for (before, weight) in run.into_iter().enumerate() {
            longer[before] += weight * deletion;
            let mut arrives = weight * (1.0 - deletion) * (1.0 - insertion);
            for slot in &mut longer[before + 1..] {
                *slot += arrives;
                arrives *= insertion;
            }
        }
        run = longer;
    }
    run
}
