//! Whose mark.

use crate::failure::Failure;
use crate::file::{load, load_text};
use clap::Args;
use meshmark::Key;
use std::path::PathBuf;

/// Whose mark. Without a passphrase file or key file, MESHMARK_PASSPHRASE is used, or the passphrase is asked for.
#[derive(Args)]
pub struct Owner {
    /// The owner's name, which with the passphrase makes the key
    #[arg(long, value_name = "NAME")]
    owner: Option<String>,
    /// File that holds the passphrase (one line end at its end is dropped)
    #[arg(long, value_name = "FILE", conflicts_with = "key_file")]
    passphrase_file: Option<PathBuf>,
    /// File of 32 bytes that is the key, instead of owner and passphrase
    #[arg(long, value_name = "FILE", conflicts_with = "owner")]
    key_file: Option<PathBuf>,
    /// Title of the work: gives it a key of its own, so that nobody can compare it with other works of the owner. Needed again to read the mark
    #[arg(long, value_name = "TITLE")]
    work: Option<String>,
}

impl Owner {
    /// The owner's name, where the key comes from one.
    pub fn name(&self) -> Option<&str> {
        self.owner.as_deref()
    }

    /// What somebody has to say on the command line to give the same key: nothing of what is secret.
    pub fn arguments(&self) -> String {
        let owner = match &self.owner {
            Some(owner) => format!("--owner {owner:?} --passphrase-file PASSPHRASE"),
            None => "--key-file KEY".to_owned(),
        };
        match &self.work {
            Some(work) => format!("{owner} --work {work:?}"),
            None => owner,
        }
    }

    pub fn key(&self) -> Result<Key, Failure> {
        let key = match (&self.key_file, &self.owner) {
            (Some(file), _) => Key::from_bytes(&load(file)?),
            (None, Some(owner)) => Key::from_passphrase(owner, &self.passphrase()?),
            // `test` needs an owner only beside works, so that this is not said by the list of arguments.
            (None, None) => {
                let words = "whose key is it? Give --owner NAME or --key-file FILE";
                return Err(Failure::Words(words.to_owned()));
            }
        };
        let key = key.map_err(Failure::of)?;
        match &self.work {
            Some(title) => key.for_work(title).map_err(Failure::of),
            None => Ok(key),
        }
    }

    fn passphrase(&self) -> Result<String, Failure> {
        if let Some(file) = &self.passphrase_file {
            let text = load_text(file)?;
            let text = text.strip_suffix('\n').unwrap_or(&text);
            return Ok(text.strip_suffix('\r').unwrap_or(text).to_owned());
        }
        match std::env::var("MESHMARK_PASSPHRASE") {
            Ok(passphrase) => Ok(passphrase),
            Err(_) => rpassword::prompt_password("Passphrase: ")
                .map_err(|error| Failure::Words(format!("the passphrase: {error}"))),
        }
    }
}
