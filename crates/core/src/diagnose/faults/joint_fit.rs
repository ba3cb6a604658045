//! A model fitted together with the faults that are found beside it.

use crate::answers::MeasurementFault;
use crate::diagnose::residuals::discrepancy;
use crate::diagnose::residuals::residual::Residuals;
use crate::diagnose::selection::models::Key;
use crate::identify::{FitAccuracy, Intervals, Model};

use super::family::Family;
use super::scan::FAR_SMALLER;
use super::suspects::{Begin, Suspected, Suspects, misfit};
use super::{fault, mending};

/// Rounds of estimating faults and refitting the model: each adds faults, or corrects the sizes of
/// those that were added.
const MOST_ROUNDS: usize = 16;

/// Rounds at the end in which the sizes settle. The second corrects what the first takes from one fault
/// of several that show alike.
const SETTLING_ROUNDS: usize = 2;

/// Most faults beside each other, all rows together counted as one. What needs more is not a
/// measurement with faults.
const MOST_FAULTS: usize = 4;

impl Suspects<'_> {
    /// The model with its faults, both fitted together; `None` if more than noise is left. Once effects
    /// were combined in vain, one fault that explains nearly all of it is enough: the effect behind it may
    /// be none of those that fit best with the fault.
    ///
    /// Before more faults are looked for, those that were found settle: the linearisation tells the size
    /// of a large one roughly, and what that leaves is no other fault.
    pub(super) fn fitted_together(
        &self,
        key: &Key,
        mut model: Model,
        begin: Begin,
        family: &Family,
    ) -> Option<Suspected> {
        let experiments = self.session.measurement().experiments();
        let (mut faults, mut price) = (Vec::<MeasurementFault>::new(), 0.0);
        let (mut are_new, mut settling) = (false, SETTLING_ROUNDS);
        let mut course = Vec::<(usize, f64)>::new();
        let mut price_of_first = None;
        for round in 0..MOST_ROUNDS {
            let session = self.session.changed(|experiment, order| {
                mending::change(&faults, experiments, experiment, order)
            });
            if round > 0 || begin == Begin::Refit {
                model = session.refine(&model, FitAccuracy::Settle);
            }
            let fit = session.judge(&model, Intervals::Curvature).ok()?;
            let cost = session.cost(&model)?;
            let scan = self.scan(&fit, cost).beside(&faults);
            let candidates = scan.candidates();
            let remainders = || self.scan(&fit, cost).remainders(&candidates, &faults);
            let unsettled = are_new.then(remainders).unwrap_or_default();
            are_new = unsettled.iter().any(|more| !fault::is_within(1.0, more));
            if are_new {
                fault::add_all(&mut faults, unsettled);
                continue;
            }
            course.push((faults.len(), cost));
            let found = scan.select(&candidates, family);
            if !found.faults.is_empty() {
                are_new = true;
                for (new, own_price) in found.faults {
                    let is_new = fault::add(&mut faults, new);
                    price += if is_new { own_price } else { 0.0 };
                }
                price_of_first.get_or_insert(price);
                if faults.len() > MOST_FAULTS {
                    return None;
                }
                continue;
            }
            if settling > 0 && !faults.is_empty() {
                settling -= 1;
                let more = remainders();
                fault::add_all(&mut faults, more);
                continue;
            }
            let before = faults.len();
            faults.retain(fault::is_sure);
            if faults.len() < before {
                continue;
            }
            let criterion = found.misfit + price + self.models.complexity(key);
            let mut residuals = Residuals::of(&fit);
            if found.std_factor.is_some() {
                residuals = residuals.of_any_size();
            }
            faults.extend(found.std_factor);
            let observer = self.session.observer();
            let is_noise = discrepancy::is_without_structure(&residuals, self.seed, observer);
            let dominates = first_dominates(&course);
            if dominates {
                faults.truncate(1);
            }
            let effects = key.len();
            if is_noise {
                return Some(Suspected { faults, criterion, price, effects });
            }
            let (_, beside_first) = *course.get(1).filter(|_| dominates && self.combined)?;
            let price = price_of_first?;
            let misfit = misfit(beside_first, self.dof(), self.size_known());
            let criterion = misfit + price + self.models.complexity(key);
            return Some(Suspected { faults, criterion, price, effects });
        }
        None
    }
}

/// Whether the first fault, found alone, explains nearly all that all of them do: numbers of faults and
/// what was left beside them, round by round. What is far smaller may be an effect of the machine,
/// which could not be fitted beside the first fault. It is looked for once that is mended.
fn first_dominates(course: &[(usize, f64)]) -> bool {
    let [(0, begin), (1, beside_first), .., (_, end)] = course else { return false };
    beside_first - end < FAR_SMALLER * (begin - end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{FaultKind, PlantRequest};
    use crate::diagnose::selection::evidence::NoiseScale;
    use crate::diagnose::selection::models::Models;
    use crate::identify::{FitSession, IdentifyRequest};
    use crate::machines::draw::{Draw, NoiseStatement, measure};
    use crate::machines::simulator::Effect;
    use crate::measurement::{Complex, Measurement, Metadata};
    use crate::observer::Silent;
    use crate::plant::{Actuator, Friction, Plant};

    /// Beside the base model, kinds of faults of an axis with static friction, of which the highest
    /// magnitude was measured with a phase 9° behind.
    fn beside_the_base_model(combined: bool) -> Option<Vec<FaultKind>> {
        let (actuator, friction) = (Actuator::Direct, Friction::coulomb(0.5, 0.4));
        let plant = Plant { viscous_rate_rad_s: 10.0, constant: 10.0, actuator, friction };
        let omegas = (0..13).map(|i| 10f64.powf(f64::from(i) / 6.0));
        let design = omegas.flat_map(|omega| [1.0, 2.0, 4.0].map(|m| (m, omega))).collect();
        let levels = [("fs_plus", 0.6), ("fs_minus", 0.48)];
        let effects = vec![Effect::new("static_friction", levels)];
        let (noise_db, noise_statement) = (Some(60.0), NoiseStatement::Std);
        let draw = Draw { plant, effects, design, harmonics: 7, noise_db, noise_statement };
        let mut experiments = measure(&draw, 6).unwrap().experiments().to_vec();
        let highest = experiments.iter_mut().filter(|experiment| experiment.magnitude == 4.0);
        for harmonic in highest.flat_map(|experiment| &mut experiment.response) {
            harmonic.value *= Complex::cis(-9f64.to_radians() * harmonic.order as f64);
        }
        let measurement =
            Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap();
        let plant = Some(PlantRequest { actuator_order: 0 });
        let request = IdentifyRequest { plant, ..IdentifyRequest::default() };
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let base = &session.judge(session.base(), Intervals::Curvature).unwrap();
        let models = &Models::new(session.base().clone(), NoiseScale::of(session));
        let suspects = Suspects { session, base, models, combined, seed: 1, lead_s: 0.0 };
        let found = suspects.best(|_| true)?;
        Some(found.faults.iter().map(|fault| fault.fault).collect())
    }

    #[test]
    fn a_fault_that_explains_nearly_all_is_enough_once_effects_were_combined_in_vain() {
        assert_eq!(beside_the_base_model(false), None);
        assert_eq!(beside_the_base_model(true), Some(vec![FaultKind::LevelPhase]));
    }

    #[test]
    fn a_first_fault_dominates_where_the_others_explain_a_twentieth_of_what_it_does() {
        let rounds = |beside_first| [(0, 1000.0), (1, beside_first), (3, 100.0), (3, 100.0)];
        assert!(first_dominates(&rounds(140.0)));
        assert!(!first_dominates(&rounds(150.0)));
        assert!(!first_dominates(&[(0, 1000.0), (2, 110.0), (3, 100.0)]), "two were found at once");
        assert!(!first_dominates(&[(1, 100.0)]));
    }
}
