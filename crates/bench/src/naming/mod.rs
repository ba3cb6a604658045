//! The benchmark of naming: hides effects in drawn machines, asks for a diagnosis through the
//! public interface, and scores what it names.
//!
//! - `case`: what a draw is, and the key from which it is drawn again.
//! - `size`, `sizing`, `excess`: how much of an effect there is, what is varied of it, and how
//!   much it shows: sizes are searched until the base model's excess χ² is the one wanted.
//! - `outsiders`: what the library does not have. `rivals`: how well a single effect of it
//!   imitates what is hidden, be it an outsider or another effect.
//! - `make`: a machine, what is hidden in it, and its measurement.
//! - `separation`: whether the next experiment ends a doubt sooner than a random one.
//! - `judge`: one answer against the truth. `rate`, `summary`, `text`: all of them.
//! - `run`: many draws at once. `search_setting`, `ablation`: what the tuned numbers of the
//!   search are worth.

mod ablation;
mod build_case;
mod case;
mod effect_scaling;
mod excess;
#[cfg(test)]
mod fixtures;
mod fresh;
mod judge;
mod outsiders;
mod rate;
mod rivals;
mod run;
mod search_setting;
mod separation;
mod sizing;
mod summary;
mod text;

pub use ablation::{Ablation, Trial, ablate};
pub use build_case::{Hidden, Made, MakeError, build_case};
pub use case::{Case, Kind, Plan, known_effect};
pub use excess::{DETECTABLE, base_excess};
pub use fresh::Fresh;
pub use judge::{Answer, Estimated, Named, Outcome, Seconds};
pub use outsiders::{OUTSIDERS, draw_outsider};
pub use rate::Rate;
pub use rivals::{Nearest, Rivals};
pub use run::{Run, Settings, Unmade, run_all, run_case};
pub use search_setting::{SettingChange, search_settings};
pub use separation::Separation;
pub use sizing::Sizing;
pub use summary::{ConfidenceBin, Confusion, EffectRates, Line, NONE, Summary, Times, Wanted};
pub use text::{case_text, misses_text, summary_text};
