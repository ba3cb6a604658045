//! The descriptor of an effect: everything about it except how it enters the simulation.

use super::draw_plan::DrawPlan;
use super::parameter::Parameter;
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// What an effect is, how a search tries it, and how the benchmark draws it.
#[derive(Debug)]
pub struct Descriptor {
    /// Identifier in the API and on the command line.
    pub id: &'static str,
    /// Name within a sentence: `Stribeck friction`.
    pub title: &'static str,
    /// The name as the object of `the axis has …`: `a spring`, but `backlash`.
    pub with_article: &'static str,
    /// Its equation, in the symbols of its parameters and of the contract.
    pub equation: &'static str,
    /// What happens in the machine, as a clause for reports.
    pub meaning: &'static str,
    /// How it shows in a frequency response, as a phrase for reports.
    pub signature: &'static str,
    /// Ids of effects that may look like it, the closest first.
    pub imitators: &'static [&'static str],
    /// The part of the axis that it takes.
    pub slot: Slot,
    /// Its parameters, in the order in which [`super::Effect::enter`] takes them.
    pub parameters: &'static [Parameter],
    /// How a search tries it.
    pub search: SearchPlan,
    /// How the benchmark draws it at random.
    pub draw: DrawPlan,
}
