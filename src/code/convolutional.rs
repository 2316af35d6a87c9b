//! A rateless, time-varying convolutional code and its list decoder.
//!
//! Memory 8, ended by 8 zero bits. There is no fixed length: every address of a carrier is a parity check of its own,
//! drawn from the key, so addresses that an attack destroys cost energy and nothing else. (A code of fixed length with
//! repetition left 6 % of the bits wrong where this one is right: erased positions of such a code cannot be made good.)
//!
//! Decoding collects the soft values of a step by taps, turns them into metrics of the register states by one Walsh-Hadamard
//! transform, and runs the Viterbi algorithm on 256 states; for a list, the parallel list one (Seshadri and Sundberg 1994).
//! O(steps * states * list).

use super::{SoftSymbol, Symbol};
use std::f64::consts::LN_2;

/// Bits of a message: 48 of payload, 12 of check.
pub const MESSAGE_BITS: u32 = 60;
const MEMORY: u32 = 8;
/// Time steps: the message, then zeros that bring the register back to its start.
pub(super) const STEPS: usize = (MESSAGE_BITS + MEMORY) as usize;
const STATES: usize = 1 << MEMORY;
/// The first and the last tap are always set: what the bits between them say is as much as there is to know of a register.
const INNER: usize = STATES / 2;

/// What symbols say, ready to give the sign of any.
#[derive(Clone)]
pub enum Codeword {
    /// A message, by the registers at each step.
    Message([u16; STEPS]),
    /// No message but that a mark is there: every parity says -1, as no message has it.
    Presence,
}

impl Codeword {
    /// Encodes the lowest 60 bits of a message, the highest of them first.
    pub fn new(message: u64) -> Codeword {
        let mut registers = [0; STEPS];
        let mut state = 0;
        for (step, register) in registers.iter_mut().enumerate() {
            let bit = if step < MESSAGE_BITS as usize {
                message >> (MESSAGE_BITS as usize - 1 - step) & 1
            } else {
                0
            };
            *register = (bit as u16) << MEMORY | state;
            state = *register >> 1;
        }
        Codeword::Message(registers)
    }

    /// +1 or -1.
    pub fn sign(&self, symbol: Symbol) -> f64 {
        match (self, symbol) {
            (_, Symbol::Pilot) => 1.0,
            (Codeword::Presence, Symbol::Parity { .. }) => -1.0,
            (Codeword::Message(registers), Symbol::Parity { step, taps }) => {
                if (registers[usize::from(step)] & taps).count_ones() & 1 == 0 {
                    1.0
                } else {
                    -1.0
                }
            }
        }
    }
}

/// The `list` likeliest messages, best first. Pilots are ignored.
pub fn decode(symbols: &[SoftSymbol], list: usize) -> Vec<u64> {
    let trellis = Trellis::new(symbols);
    if list == 1 {
        vec![trellis.best_path(std::iter::empty())]
    } else {
        trellis.best_paths(list)
    }
}

/// The likeliest message whose first `num_known` bits are those of `known`, the highest first. Pilots are ignored.
pub fn complete(symbols: &[SoftSymbol], known: u64, num_known: u32) -> u64 {
    let known = (0..num_known).rev().map(|bit| known >> bit & 1 == 1);
    Trellis::new(symbols).best_path(known)
}

/// The metric of every register's inner bits at every step, where the first and the last bit are equal; where they differ it is
/// the negative.
pub(super) struct Trellis(Vec<[f64; INNER]>);

/// The states before a state: which is reached depends on the bit that left the register.
fn before(state: usize) -> [usize; 2] {
    let low = (state << 1) & (STATES - 1);
    [low, low | 1]
}

/// One way to reach a state: its metric, the predecessor, and which of the predecessor's ways it prolongs.
#[derive(Clone, Copy)]
struct Path {
    metric: f64,
    state: u8,
    rank: u16,
}

impl Trellis {
    pub fn new(symbols: &[SoftSymbol]) -> Trellis {
        let mut steps = vec![[0.0; INNER]; STEPS];
        for soft in symbols {
            if let Symbol::Parity { step, taps } = soft.symbol {
                let inner = usize::from(taps) / 2 % INNER;
                steps[usize::from(step)][inner] += soft.value;
            }
        }
        steps.iter_mut().for_each(walsh_hadamard);
        Trellis(steps)
    }

    /// The sum of soft values times the signs of a codeword.
    pub fn sum(&self, codeword: &Codeword) -> f64 {
        let Codeword::Message(registers) = codeword else {
            return 0.0;
        };
        let steps = registers.iter().zip(&self.0);
        steps
            .map(|(register, metrics)| {
                let register = usize::from(*register);
                let metric = metrics[register / 2 % INNER];
                if (register ^ register >> MEMORY) & 1 == 0 {
                    metric
                } else {
                    -metric
                }
            })
            .sum()
    }

    /// The logarithm of the mean, over all messages, of `exp(exponent * sum)`: log domain, so that nothing overflows or is lost.
    pub fn ln_moment(&self, exponent: f64) -> f64 {
        let mut reached = [f64::NEG_INFINITY; STATES];
        reached[0] = 0.0;
        for (step, metrics) in self.0.iter().enumerate() {
            let mut next = [f64::NEG_INFINITY; STATES];
            let (low, high) = next.split_at_mut(INNER);
            let is_message = step < MESSAGE_BITS as usize;
            for (inner, from) in reached.as_chunks::<2>().0.iter().enumerate() {
                let (metric, [a, b]) = (exponent * metrics[inner], *from);
                low[inner] = ln_sum(a + metric, b - metric);
                if is_message {
                    high[inner] = ln_sum(a - metric, b + metric);
                }
            }
            if is_message {
                next.iter_mut().for_each(|reached| *reached -= LN_2);
            }
            reached = next;
        }
        reached[0]
    }

    /// The likeliest message that begins with the bits that are known.
    fn best_path(&self, mut known: impl Iterator<Item = bool>) -> u64 {
        let mut reached = [f64::NEG_INFINITY; STATES];
        reached[0] = 0.0;
        let choices: Vec<[bool; STATES]> = self
            .0
            .iter()
            .map(|metrics| {
                let mut choice = [false; STATES];
                let mut next = [0.0; STATES];
                let (low, high) = next.split_at_mut(INNER);
                let (low_choice, high_choice) = choice.split_at_mut(INNER);
                for (inner, from) in reached.as_chunks::<2>().0.iter().enumerate() {
                    let (metric, [a, b]) = (metrics[inner], *from);
                    (low[inner], low_choice[inner]) = better(a + metric, b - metric);
                    (high[inner], high_choice[inner]) = better(a - metric, b + metric);
                }
                // A new bit enters at the top: it is 0 in the lower half of the states.
                match known.next() {
                    Some(true) => low.fill(f64::NEG_INFINITY),
                    Some(false) => high.fill(f64::NEG_INFINITY),
                    None => {}
                }
                reached = next;
                choice
            })
            .collect();
        let (mut state, mut message) = (0, 0);
        for (step, choice) in choices.iter().enumerate().rev() {
            message |= bit(step, state);
            state = before(state)[usize::from(choice[state])];
        }
        message
    }

    fn best_paths(&self, list: usize) -> Vec<u64> {
        let mut layers = vec![Layer::origin(list)];
        for (step, metrics) in self.0.iter().enumerate() {
            let reached = &layers[step];
            let mut next = Layer::empty(list);
            // Past the message every input is zero: only the lower half of the states can be reached.
            let num_states = if step < MESSAGE_BITS as usize {
                STATES
            } else {
                STATES / 2
            };
            for state in 0..num_states {
                let metric = metrics[state % INNER];
                let [a, b] = before(state).map(|from| {
                    let differ = (state >> (MEMORY - 1)) ^ (from & 1) == 1;
                    let branch = if differ { -metric } else { metric };
                    reached
                        .paths(from)
                        .iter()
                        .enumerate()
                        .map(move |(rank, path)| Path {
                            metric: path.metric + branch,
                            state: from as u8,
                            rank: rank as u16,
                        })
                });
                next.merge(state, a, b);
            }
            layers.push(next);
        }
        (0..layers[STEPS].counts[0])
            .map(|rank| trace(&layers, rank))
            .collect()
    }
}

/// The logarithm of the sum of two numbers that are given by theirs.
fn ln_sum(a: f64, b: f64) -> f64 {
    let (less, more) = if a < b { (a, b) } else { (b, a) };
    if less == f64::NEG_INFINITY {
        return more;
    }
    more + libm::log1p(libm::exp(less - more))
}

/// The larger of two metrics, and whether it is the second; the first wins ties.
fn better(a: f64, b: f64) -> (f64, bool) {
    if b > a { (b, true) } else { (a, false) }
}

/// The best ways to every state at one time, best first.
struct Layer {
    list: usize,
    paths: Vec<Path>,
    counts: [usize; STATES],
}

impl Layer {
    fn empty(list: usize) -> Layer {
        let nowhere = Path {
            metric: 0.0,
            state: 0,
            rank: 0,
        };
        Layer {
            list,
            paths: vec![nowhere; STATES * list],
            counts: [0; STATES],
        }
    }

    /// One way to the state zero.
    fn origin(list: usize) -> Layer {
        let mut layer = Layer::empty(list);
        layer.counts[0] = list.min(1);
        layer
    }

    fn paths(&self, state: usize) -> &[Path] {
        &self.paths[state * self.list..][..self.counts[state]]
    }

    /// Sets a state's ways to the best of two sequences, each of them best first; the first wins ties.
    fn merge(
        &mut self,
        state: usize,
        a: impl Iterator<Item = Path>,
        b: impl Iterator<Item = Path>,
    ) {
        let (mut a, mut b) = (a.peekable(), b.peekable());
        let slots = &mut self.paths[state * self.list..][..self.list];
        for slot in slots {
            let best = match (a.peek(), b.peek()) {
                (Some(x), Some(y)) if y.metric > x.metric => b.next(),
                (Some(_), _) => a.next(),
                (None, _) => b.next(),
            };
            let Some(best) = best else { break };
            *slot = best;
            self.counts[state] += 1;
        }
    }
}

/// The message of one of the ways to the last state.
fn trace(layers: &[Layer], rank: usize) -> u64 {
    let (mut state, mut rank, mut message) = (0, rank, 0);
    for step in (0..STEPS).rev() {
        message |= bit(step, state);
        let path = layers[step + 1].paths(state)[rank];
        (state, rank) = (usize::from(path.state), usize::from(path.rank));
    }
    message
}

/// What a message has at a step that led to a state, whose highest bit was the input; behind the message there are zeros.
fn bit(step: usize, state: usize) -> u64 {
    let input = (state >> (MEMORY - 1)) as u64;
    (input << MESSAGE_BITS)
        .checked_shr(step as u32 + 1)
        .unwrap_or(0)
}

/// In place: `y[r] = sum over t of x[t] * (-1)^popcount(r & t)`.
fn walsh_hadamard(x: &mut [f64; INNER]) {
    let mut half = 1;
    while half < INNER {
        for block in x.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (a, b) in low.iter_mut().zip(high) {
                (*a, *b) = (*a + *b, *a - *b);
            }
        }
        half *= 2;
    }
}
