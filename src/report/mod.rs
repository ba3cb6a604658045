//! Answers as a person reads them. Knows results, never solvers.

mod brief;
mod causes;
mod columns;
mod diagnosis;
pub mod figures;
mod inspection;
mod measurement;
mod number;
pub mod page;
mod plan;
pub mod script;
mod size;
mod summary;
mod tables;
mod text;
mod units;
mod validation;
mod words;
mod written;

use servoscope_core::answers::Answer;

pub use diagnosis::diagnosis;
pub use inspection::inspection;
pub use plan::{plan, plan_csv};
pub use summary::{headline, summary};
pub use text::identification;
pub use validation::validation;
pub use words::with_causes;

/// Everything that an answer of either kind says, in lines of at most `width` columns but for
/// words that are longer.
pub fn answer(answer: &Answer, width: usize) -> String {
    let text = match answer {
        Answer::Identification(answer) => identification(answer),
        Answer::Diagnosis(answer) => diagnosis(answer),
    };
    let verdict = text.lines().next().unwrap_or_default().to_owned();
    let lines = text.lines().flat_map(|line| match line.chars().count() > width {
        true => summary::wrapped(line, width),
        false => vec![line.to_owned()],
    });
    lines.chain([String::new(), verdict, String::new()]).collect::<Vec<_>>().join("\n")
}
