//! A payload as an argument.

use crate::failure::Failure;
use clap::Args;
use meshmark::Payload;

#[derive(Args)]
#[group(required = true, multiple = false)]
pub struct PayloadArgument {
    /// 1 to 8 characters: A-Z a-z 0-9 - . (the last not .)
    #[arg(long)]
    tag: Option<String>,
    /// A whole number below 2^48, instead of a tag
    #[arg(long)]
    number: Option<u64>,
}

impl PayloadArgument {
    pub fn read(&self) -> Result<Payload, Failure> {
        let payload = match (&self.tag, self.number) {
            (Some(tag), _) => Payload::from_tag(tag),
            (None, number) => Payload::from_number(number.unwrap_or_default()),
        };
        payload.map_err(Failure::of)
    }
}
