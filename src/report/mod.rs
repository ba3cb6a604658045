//! Answers as a person reads them. Knows results, never solvers.

mod causes;
mod columns;
mod diagnosis;
pub mod figures;
mod inspection;
mod measurement;
mod number;
pub mod page;
mod tables;
mod text;
mod validation;
mod written;

use servoscope_core::answers::Answer;

pub use causes::with_causes;
pub use diagnosis::diagnosis;
pub use inspection::inspection;
pub use text::identification;
pub use validation::validation;

/// An answer of either kind.
pub fn answer(answer: &Answer) -> String {
    match answer {
        Answer::Identification(answer) => identification(answer),
        Answer::Diagnosis(answer) => diagnosis(answer),
    }
}
