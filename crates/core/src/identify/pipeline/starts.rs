//! The stages that find the points to refine: closed form, network and search.

use std::ops::ControlFlow;

use super::{Run, StageResults};
use crate::identify::closed_form;
use crate::identify::methods::Steps;
use crate::identify::objective::Misfit;
use crate::identify::optimiser::{self, Optimiser, Search};
use crate::identify::proposal;
use crate::identify::request::IdentifyError;
use crate::identify::unit_cube_objective::OverCube;

impl Run<'_> {
    /// The points to refine: those of every stage that the method has and the options enable.
    pub(super) fn starts(
        &self,
        misfit: &Misfit<'_>,
        found: &mut StageResults,
    ) -> Result<(), IdentifyError> {
        let Steps { closed_form, network, search, .. } = self.steps;
        if search.is_none() {
            self.closed_form_alone(misfit, found)?;
        } else if *closed_form && self.options.closed_form_start {
            self.closed_form(misfit, found);
        }
        if let Some(known) = self.known {
            found.sources.push(misfit.coordinates.share_of_search(&known.point));
            found.starts.push(known.point.clone());
        } else if *network && self.options.network.enabled {
            self.network(misfit, found)?;
        }
        let searches =
            |search: &&dyn Optimiser| self.known.is_none() && search.is_enabled(self.options);
        if let Some(optimiser) = search.filter(searches) {
            self.search(optimiser, misfit, found)?;
        }
        if found.starts.is_empty() {
            let coordinates = misfit.coordinates;
            let mut middle = coordinates.within_search(&vec![0.5; coordinates.len() - 1]);
            misfit.solve_for_constant(&mut middle);
            found.starts.push(middle);
        }
        Ok(())
    }

    fn closed_form(&self, misfit: &Misfit<'_>, found: &mut StageResults) {
        let begun = self.history.begin("closed_form", 1);
        if let Some(plant) = closed_form::start(self.problem, self.history.order) {
            let mut point = misfit.coordinates.point(&plant);
            let cost = misfit.solve_for_constant(&mut point);
            begun.row(0, 1, cost, None);
            found.stages.push(begun.end(1, cost, &self.in_units(misfit, &point), "solved"));
            found.sources.push(misfit.coordinates.share_of_search(&point));
            found.starts.push(point);
        }
        let beside_actuators = closed_form::beside_actuators(self.problem, self.history.order);
        found.beside_actuators = beside_actuators.map(|plant| misfit.coordinates.point(&plant));
    }

    fn network(&self, misfit: &Misfit<'_>, found: &mut StageResults) -> Result<(), IdentifyError> {
        let options = &self.options.network;
        let begun = self.history.begin("network", options.epochs as u64);
        let plants = options.training_plants as u64;
        let mut rng = self.stream(1);
        let proposal =
            proposal::propose(misfit, options, &mut rng, &mut |epoch, training, held_out| {
                begun.row(epoch as u64, plants, held_out, Some(training));
                begun.progress(epoch as u64);
            });
        self.history.check_cancelled()?;
        if let Some(proposal) = proposal {
            let point = proposal.point(misfit.coordinates);
            let cost = misfit.cost(&point);
            let plant = self.in_units(misfit, &point);
            let used = proposal.evaluations + 1;
            found.stages.push(begun.end(used, cost, &plant, "every epoch trained"));
            found.starts.push(point);
            let wanted = self.options.colony.food_sources.saturating_sub(found.sources.len());
            found.sources.extend(proposal.food_sources(wanted.max(1), &mut rng));
        }
        Ok(())
    }

    /// The closed form as the answer of the method. It requires two magnitudes at one frequency. If
    /// these show no actuator of this order, the plant of the next lower order is taken, with an
    /// additional pole too fast to be seen.
    fn closed_form_alone(
        &self,
        misfit: &Misfit<'_>,
        found: &mut StageResults,
    ) -> Result<(), IdentifyError> {
        let unusable = |reason: &str| IdentifyError::Unusable { reason: reason.into() };
        if !closed_form::has_two_magnitudes(self.problem) {
            return Err(unusable(
                "two-magnitude needs single sines at two magnitudes of one frequency, both of \
                 which move the axis; other methods need less",
            ));
        }
        self.closed_form(misfit, found);
        if found.starts.is_empty() {
            found.starts.extend(self.start_of_lower(misfit.coordinates));
        }
        if found.starts.is_empty() {
            return Err(unusable(
                "the method two-magnitude finds no axis with this actuator order; leave out the \
                 order or use another method",
            ));
        }
        Ok(())
    }

    fn search(
        &self,
        optimiser: &dyn Optimiser,
        misfit: &Misfit<'_>,
        found: &mut StageResults,
    ) -> Result<(), IdentifyError> {
        let budget = optimiser.budget(self.options);
        let begun = self.history.begin(optimiser.stage(), budget as u64).within(budget as u64);
        let objective = OverCube { misfit };
        let mut watch = |generation: &optimiser::Generation| {
            let optimiser::Generation { index, evaluations, best, mean } = *generation;
            begun.row(index as u64, evaluations as u64, best, mean);
            begun.progress(evaluations as u64);
            match self.history.observer.cancelled() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let mut search = Search::new(&objective, &found.sources, self.options, budget, &mut watch);
        let Err(stop) = optimiser.search(&mut search, &mut self.stream(2));
        self.history.check_cancelled()?;
        let used = search.used() as u64;
        let Some((best, _)) = search.best() else { return Ok(()) };
        let mut point = misfit.coordinates.within_search(best);
        let cost = misfit.solve_for_constant(&mut point);
        let plant = self.in_units(misfit, &point);
        found.stages.push(begun.end(used, cost, &plant, stop.reason()));
        found.starts.push(point);
        Ok(())
    }
}
