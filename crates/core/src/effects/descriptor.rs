//! The descriptor of an effect: everything about it but how it enters the simulation.

use super::draw_plan::DrawPlan;
use super::parameter::Parameter;
use super::search_plan::SearchPlan;
use super::slot::Slot;

/// What an effect is, how it is searched for, and how a benchmark draws it.
#[derive(Debug)]
pub struct Descriptor {
    /// Identifier on the wire and on the command line.
    pub id: &'static str,
    /// Name in a sentence: `Stribeck friction`.
    pub title: &'static str,
    /// The same as something that an axis has: `a spring`, but `backlash`.
    pub with_article: &'static str,
    /// Its equation, in the symbols of its parameters and of the contract.
    pub equation: &'static str,
    /// What it is in the machine, for a person.
    pub meaning: &'static str,
    /// What it looks like in a response, for a person.
    pub signature: &'static str,
    /// Ids of effects that may look like it.
    pub imitators: &'static [&'static str],
    /// The place in the chain that it fills.
    pub slot: Slot,
    /// Its parameters, in the order in which [`super::Effect::enter`] takes them.
    pub parameters: &'static [Parameter],
    /// How a search tries it.
    pub search: SearchPlan,
    /// How a benchmark draws it.
    pub draw: DrawPlan,
}
