//! Turns the chosen model into named causes, each with its confidence and its equivalents.

use indexmap::IndexMap;

use crate::answers::{Candidate, Cause, Identification};
use crate::effects::{Descriptor, are_confusable, fit_words};
use crate::identify::Model;
use crate::measurement::Metadata;

use super::confidence::Standing;
use super::models::{Key, Models};

/// Two models whose −2 ln evidence differs by less than this cannot be told apart: a Bayes factor
/// below e^(9/2) ≈ 90. Tuned.
pub(crate) const EQUIVALENCE_MARGIN: f64 = 9.0;

/// Equivalents listed for one cause, at most.
const MOST_EQUIVALENTS: usize = 2;

/// Probability that each cause of a convincing pair must have, together with the effects confusable
/// with it. Tuned.
const CONVINCING_PROBABILITY: f64 = 0.9;

/// Whether a model that leaves only noise is more than an imitation of one effect that the library
/// lacks. Two effects that bend the response in the same way can follow nearly any third; so can
/// two if an unrelated effect fits as well in the place of one. Three or more can follow anything.
pub(crate) fn convincing(models: &Models, chosen: &Key) -> bool {
    let alike = |one: &str, other: &str| {
        let effects = models.effect(one).zip(models.effect(other));
        effects.is_some_and(|(one, other)| are_confusable(one, other))
    };
    let is_likely = |id: &&str| {
        models.probability(|other| other == *id || alike(other, id)) >= CONVINCING_PROBABILITY
    };
    match chosen.as_slice() {
        [] | [_] => true,
        [one, other] => !alike(one, other) && chosen.iter().all(is_likely),
        _ => false,
    }
}

/// The causes of the model `chosen`, strongest first; `fits` says whether it leaves only noise.
/// `extended` is the same model with its reported parameters; `metadata` says whether it is a force
/// or a torque that moves the axis.
pub(crate) fn named(
    models: &Models,
    chosen: &Key,
    extended: &Identification,
    fits: bool,
    metadata: &Metadata,
) -> Vec<Cause> {
    let standing = Standing { models, chosen };
    let mut causes: Vec<(f64, Cause)> = chosen
        .iter()
        .filter_map(|id| models.effect(id))
        .map(|effect| {
            let id = effect.id();
            let parameters: IndexMap<_, _> = effect
                .parameters()
                .iter()
                .filter_map(|parameter| {
                    let estimate = extended.parameters.get(&effect.key(parameter))?;
                    Some((parameter.name.to_owned(), estimate.clone()))
                })
                .collect();
            let cause = Cause {
                effect: id.to_owned(),
                parameters,
                confidence: standing.confidence(id, fits),
                margin: Some(standing.factor(id)).filter(|factor| factor.is_finite()),
                explanation: explanation(effect.descriptor(), metadata),
                gain: None,
                equivalents: rivals(models, chosen, id).into_iter().map(|r| r.0.into()).collect(),
            };
            (models.loss(chosen, id), cause)
        })
        .collect();
    causes.sort_by(|a, b| b.0.total_cmp(&a.0));
    causes.into_iter().map(|(_, cause)| cause).collect()
}

/// What an effect does and how it shows, in words that fit the axis.
fn explanation(effect: &Descriptor, Metadata { input, response, .. }: &Metadata) -> String {
    let text = format!("{}. How it shows: {}", effect.meaning, effect.signature);
    fit_words(&text, &input.unit, &response.unit)
}

/// Effects that explain the data as well as `id` does, in its place beside the other effects of
/// `chosen`: by the evidence, or by their predictions of held-out data
/// ([`Models::predict_alike`]). The best comes first; each comes with its model.
pub(crate) fn rivals<'s>(
    models: &'s Models,
    chosen: &Key,
    id: &str,
) -> Vec<(&'static str, &'s Model)> {
    let rest: Key = chosen.iter().copied().filter(|other| *other != id).collect();
    let own = models.criterion(chosen);
    let mut rivals: Vec<(f64, &'static str, &Model)> = models
        .all()
        .filter(|(key, _)| key.len() == chosen.len() && *key != chosen)
        .filter(|(key, _)| rest.iter().all(|other| key.contains(other)))
        .filter_map(|(key, model)| {
            let other = key.iter().find(|other| !rest.contains(other))?;
            let difference = models.criterion(key) - own;
            let is_alike = difference < EQUIVALENCE_MARGIN || models.predict_alike.contains(key);
            is_alike.then_some((difference, *other, model))
        })
        .collect();
    rivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    rivals.into_iter().take(MOST_EQUIVALENTS).map(|(_, id, model)| (id, model)).collect()
}

/// Every effect that was fitted alone and has a finite criterion, the best first. `withdrawn` are
/// the effects of the best model if it predicts held-out data no better than the base model.
pub(crate) fn candidates(models: &Models, chosen: &Key, withdrawn: &Key) -> Vec<Candidate> {
    let noise_scale = &models.noise_scale;
    let before = models.get(&Key::new()).map_or(f64::NAN, |base| noise_scale.misfit(base.cost));
    let mut candidates: Vec<Candidate> = models
        .all()
        .filter(|(key, _)| models.criterion(key).is_finite())
        .filter_map(|(key, model)| {
            let &[id] = key.as_slice() else { return None };
            let rejected =
                (!chosen.contains(&id)).then(|| rejection(models, chosen, withdrawn, id));
            Some(Candidate {
                effect: id.to_owned(),
                cost: model.cost,
                delta_chi2: before - noise_scale.misfit(model.cost),
                criterion: models.criterion(key),
                heldout_error: None,
                rejected,
            })
        })
        .collect();
    candidates.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    candidates
}

fn rejection(models: &Models, chosen: &Key, withdrawn: &Key, id: &'static str) -> String {
    let single = vec![id];
    if !models.supported(&single) {
        return "the improvement may be chance".into();
    }
    if withdrawn.contains(&id) {
        return "it predicts held-out data no better than the base model".into();
    }
    if chosen.is_empty() && withdrawn.is_empty() {
        return "the improvement does not justify its parameters".into();
    }
    if models.predict_alike.contains(&single) {
        return format!("it predicts held-out data no better than {}", chosen.join(" with "));
    }
    let mut with: Key = chosen.iter().copied().chain([id]).collect();
    with.sort_unstable();
    match models.get(&with).is_some() && !chosen.is_empty() {
        true => format!("beside {} the improvement may be chance", chosen.join(" and ")),
        false => {
            let better = if chosen.is_empty() { withdrawn } else { chosen };
            format!("{} explains the data better", better.join(" with "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::selection::familywise_threshold::FamilywiseThreshold;
    use crate::diagnose::tests::{fitted_to, key};
    use crate::effects::find;

    #[test]
    fn two_causes_convince_unless_they_are_confusable_or_one_has_an_unrelated_rival() {
        let pair = ["spring", "transport_delay"];
        let alone = fitted_to(&[(&["spring"], 1e4), (&pair, 100.0)]);
        assert!(convincing(&alone, &key(&pair)));
        let might_lag = fitted_to(&[(&pair, 100.0), (&["spring", "sensor_lag"], 100.0)]);
        assert!(convincing(&might_lag, &key(&pair)), "a lag is what a delay is mistaken for");
        let might_drift = fitted_to(&[(&pair, 100.0), (&["spring", "friction_drift"], 100.0)]);
        assert!(!convincing(&might_drift, &key(&pair)));
        let alike = ["quadratic_drag", "stribeck"];
        assert!(!convincing(&fitted_to(&[(&alike, 100.0)]), &key(&alike)));
    }

    #[test]
    fn one_cause_convinces_and_three_do_not() {
        let three = ["spring", "transport_delay", "friction_drift"];
        let models = fitted_to(&[(&["spring"], 100.0), (&three, 50.0)]);
        assert!(convincing(&models, &key(&["spring"])) && convincing(&models, &Key::new()));
        assert!(!convincing(&models, &key(&three)));
    }

    #[test]
    fn an_explanation_tells_of_a_force_where_the_axis_is_linear() {
        let spring = find("spring").unwrap().descriptor();
        let told = |input: &str, response: &str| {
            let mut metadata = Metadata::default();
            metadata.input.unit = input.into();
            metadata.response.unit = response.into();
            explanation(spring, &metadata)
        };
        for [input, response] in [["N", "m"], ["A", "mm/s"]] {
            let text = told(input, response);
            assert!(text.starts_with("a restoring force is in proportion"), "{text}");
            assert!(text.contains(". How it shows: ") && !text.contains("torque"), "{text}");
        }
        assert!(told("A", "rad/s").starts_with("a restoring torque"));
        assert!(told("", "").starts_with("a restoring force or torque"));
    }

    #[test]
    fn where_the_best_model_was_withdrawn_every_effect_says_why_it_is_not_named() {
        let mut models = fitted_to(&[(&["spring"], 100.0), (&["transport_delay"], 150.0)]);
        models.family = Some(FamilywiseThreshold::with_low_limits(&["spring", "transport_delay"]));
        let said =
            |withdrawn: &[&'static str], id| rejection(&models, &Key::new(), &key(withdrawn), id);
        assert_eq!(
            said(&["spring"], "spring"),
            "it predicts held-out data no better than the base model"
        );
        assert_eq!(said(&["spring"], "transport_delay"), "spring explains the data better");
        assert_eq!(said(&[], "spring"), "the improvement does not justify its parameters");
        assert!(said(&[], "cogging").contains("may be chance"));
        models.predict_alike.insert(key(&["transport_delay"]));
        assert_eq!(
            rejection(&models, &key(&["spring"]), &Key::new(), "transport_delay"),
            "it predicts held-out data no better than spring"
        );
    }

    #[test]
    fn rivals_fit_as_well_in_the_same_place_and_the_best_comes_first() {
        let mut models = fitted_to(&[
            (&["sensor_lag"], 101.0),
            (&["transport_delay"], 100.0),
            (&["friction_drift"], 150.0),
            (&["sensor_lag", "spring"], 99.0),
        ]);
        let ids = |models: &Models| -> Vec<&str> {
            let found = rivals(models, &key(&["transport_delay"]), "transport_delay");
            found.into_iter().map(|rival| rival.0).collect()
        };
        assert_eq!(ids(&models), ["sensor_lag"]);
        models.predict_alike.insert(key(&["friction_drift"]));
        assert_eq!(ids(&models), ["sensor_lag", "friction_drift"]);
    }
}
