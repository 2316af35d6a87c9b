//! The rooms behind the page, as docs/ARCHITECTURE.md lists them: for this project's own tests, benchmarks, lab and command line.
//!
//! Nothing here is promised: a room changes with any release.

/// A room, whole.
macro_rules! room {
    ($($name:ident)*) => { $(
        #[doc(hidden)]
        pub mod $name {
            pub use crate::$name::*;
        }
    )* };
}

room!(attack carrier code detection digest document evidence geometry key mesh paper progress scene);

#[doc(hidden)]
pub use crate::watermark::{Beside, strangers, trace_all};
