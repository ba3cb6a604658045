//! Family-wise error rate: by how much an effect must lower χ² to be more than chance.
//!
//! Noise is drawn and projected as the fit of the base model leaves it. From each draw every effect
//! gains the squared length of the noise in the directions in which the effect would show, at the
//! best values of its parameters. An effect's p-value must be below the smallest p-value, over all
//! effects, of nearly every draw (min-p; Westfall and Young 1993, ISBN 978-0-471-55761-6). This is
//! right whatever parameters the null hypothesis leaves unidentified (Davies 1987,
//! doi:10.1093/biomet/74.1.33), with deviations given, estimated or unknown.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::identify::FitSession;

use crate::diagnose::residuals::null_distribution::NullDistribution;
use crate::diagnose::residuals::subspace::Subspace;
use crate::diagnose::search::linearization::Linearization;
use crate::diagnose::search::score_tests::Probed;

/// Number of draws of noise.
const DRAWS: u64 = 600;

/// Family-wise error rate: probability that any effect is named where none is missing.
const LEVEL: f64 = 0.003;

/// Null distributions of the gains of a family of effects, and the common p-value limit.
#[derive(Clone)]
pub(crate) struct FamilywiseThreshold {
    /// Effect id and null distribution of its gain in χ².
    members: Vec<(&'static str, NullDistribution)>,
    /// p-value below which an effect is significant.
    p_value_limit: f64,
}

impl FamilywiseThreshold {
    /// The family of the effects in `probed`, which were probed at `linearization`; `scale_known`
    /// says whether the size of the noise is known. Once the observer cancels, no effect can be
    /// significant.
    pub fn new(
        session: &FitSession<'_>,
        linearization: &Linearization,
        scale_known: bool,
        probed: &[Probed],
        seed: u64,
    ) -> Self {
        Self::at_level(LEVEL, session, linearization, scale_known, probed, seed)
    }

    fn at_level(
        level: f64,
        session: &FitSession<'_>,
        linearization: &Linearization,
        scale_known: bool,
        probed: &[Probed],
        seed: u64,
    ) -> Self {
        let law = session.noise();
        let seen: Vec<&Probed> = probed.iter().filter(|probed| !probed.spans.is_empty()).collect();
        let none = Self { members: Vec::new(), p_value_limit: 0.0 };
        let drawn: Option<Vec<DVector<f64>>> = (0..DRAWS)
            .into_par_iter()
            .map(|draw| {
                if session.observer().cancelled() {
                    return None;
                }
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream((1 << 32) + draw);
                let mut left = linearization.fitted.complement(&law.draw(&mut rng));
                if !scale_known {
                    left *= (linearization.dof() / left.norm_squared()).sqrt();
                }
                Some(left)
            })
            .collect();
        let Some(drawn) = drawn.filter(|_| !seen.is_empty()) else { return none };
        let drawn = DMatrix::from_columns(&drawn);
        // The largest energy of each draw in the directions of an effect.
        let gains = |probed: &&Probed| match session.observer().cancelled() {
            true => None,
            false => Some(Subspace::largest_energies(&probed.spans, &drawn)),
        };
        let gains: Option<Vec<Vec<f64>>> = seen.par_iter().map(gains).collect();
        let Some(gains) = gains else { return none };
        let named = seen.iter().map(|probed| probed.effect.id());
        let members: Vec<(&'static str, NullDistribution)> =
            named.zip(gains.iter().cloned().map(NullDistribution::new)).collect();
        let smallest = |draw: usize| {
            let p_values =
                members.iter().zip(&gains).map(|((_, null), gains)| null.p_value(gains[draw]));
            // −ln p, because `NullDistribution` extrapolates the upper tail.
            -p_values.fold(1.0, f64::min).ln()
        };
        let p_values = NullDistribution::new((0..drawn.ncols()).map(smallest).collect());
        let p_value_limit = (-p_values.limit(level)).exp();
        Self { members, p_value_limit }
    }

    /// A family of effects that gain at most 1 by chance, so that their limits are low.
    #[cfg(test)]
    pub fn with_low_limits(ids: &[&'static str]) -> Self {
        let null = || NullDistribution::new((1..=100).map(|i| 0.01 * f64::from(i)).collect());
        Self { members: ids.iter().map(|id| (*id, null())).collect(), p_value_limit: LEVEL }
    }

    /// By how much an effect must lower χ² to be significant; infinite for one that cannot show.
    pub fn limit(&self, id: &str) -> f64 {
        let member = self.members.iter().find(|(member, _)| *member == id);
        member.map_or(f64::INFINITY, |(_, null)| null.limit(self.p_value_limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::score_tests::Changes;
    use crate::diagnose::selection::evidence::NoiseScale;
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::effects::{ALL, Effect};
    use crate::identify::FitAccuracy;
    use crate::machines::draw::NoiseStatement;
    use crate::observer::Silent;

    /// Whether any effect, fully refitted with the base model to data with this noise, exceeds its
    /// limit at a family-wise error rate of 5 %.
    fn is_exceeded(statement: NoiseStatement, seed: u64) -> bool {
        let (measurement, request) = (noisy(&exact(), statement, seed), request());
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let known = session.noise_known();
        let base = session.base();
        let linearization = Linearization::new(&session, base).unwrap();
        let noise_scale =
            NoiseScale { known, rounding: session.rounding(), dof: linearization.dof() };
        let testable =
            |effect: &&&'static dyn Effect| session.runs_known() || !effect.search().needs_run;
        let probe = |effect: &'static dyn Effect| {
            Changes::of(&session, &linearization, effect).probe(&session, &linearization)
        };
        let probed: Vec<Probed> =
            ALL.iter().filter(testable).map(|effect| probe(*effect)).collect();
        let gain = |probed: &Probed| {
            let starts = probed.probes.iter().take(2).map(|probe| &probe.start);
            let costs = starts.map(|start| session.refine(start, FitAccuracy::Settle).cost);
            let misfit = noise_scale.misfit(costs.fold(base.cost, f64::min));
            (probed.effect.id(), noise_scale.misfit(base.cost) - misfit)
        };
        let gains: Vec<(&str, f64)> = probed.par_iter().map(gain).collect();
        let family =
            FamilywiseThreshold::at_level(0.05, &session, &linearization, known, &probed, seed);
        gains.iter().any(|(id, gain)| *gain > family.limit(id))
    }

    /// See `.ci/long`.
    mod long {
        use super::*;

        // At most 9 of 180 are expected, with a standard deviation of 2.9; four of those are allowed.
        #[test]
        #[ignore = "slow: 180 measurements, to each of which every effect is fitted"]
        fn full_refits_exceed_the_limits_no_more_often_than_the_family_wise_error_rate() {
            let statements =
                [NoiseStatement::Std, NoiseStatement::Repeats(6), NoiseStatement::Silent];
            let counts = statements
                .map(|statement| (300..360).filter(|seed| is_exceeded(statement, *seed)).count());
            println!("{counts:?} of 60 each, by {statements:?}");
            assert!(counts.iter().sum::<usize>() <= 20, "{counts:?}");
        }
    }
}
