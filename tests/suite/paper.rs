//! The seed paper: its watermarking system, Table I and Fig. 5.

mod chain;
mod figure_5;
mod stability;
mod study;
