//! Whether the answer to a mended measurement stands.

use crate::answers::{Diagnosis, FaultKind, Fit, MeasurementFault, Verdict};

use super::fault::is_certain;
use super::suspects::{self, CLEARLY_BETTER};

/// Whether a fault stands even where no model beside it leaves only noise.
pub(super) fn stands_alone(fault: &MeasurementFault) -> bool {
    is_certain(fault) || matches!(fault.fault, FaultKind::HeldInput | FaultKind::StraightInput)
}

/// Whether a fault changes all that was measured together by one number, and leaves nothing out.
pub(super) fn changes_all_alike(fault: &MeasurementFault) -> bool {
    fault.left_out.is_empty() && fault.fault != FaultKind::StdFactor
}

/// Whether an answer to the mended measurement, which leaves more than noise, is still clearly better
/// than that to the measurement as it is.
pub(super) fn is_clearly_better(mended: &Diagnosis, whole: &Diagnosis) -> bool {
    let best = |answer: &Diagnosis| answer.extended.as_ref().unwrap_or(&answer.base).fit.clone();
    let (mended, whole) = (best(mended), best(whole));
    let left = |fit: &Fit| fit.nrmse.powi(2);
    let (ours, theirs) = match mended.chi2.zip(whole.chi2) {
        Some(both) => both,
        // Weights differ where the noise is not used.
        None => (left(&mended), left(&whole)),
    };
    let dof = mended.dof.max(1) as f64;
    suspects::misfit(theirs, dof, false) - suspects::misfit(ours, dof, false) > CLEARLY_BETTER
}

/// Whether the answer's best model leaves only noise, and convinces.
pub(super) fn is_explained(answer: &Diagnosis) -> bool {
    matches!(answer.verdict, Verdict::Adequate | Verdict::Explained)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::sample;

    #[test]
    fn a_mended_measurement_is_clearly_better_by_its_evidence_and_not_by_what_is_left_out() {
        let mended = sample::diagnosis();
        let leaving = |times: f64| {
            let mut whole = sample::diagnosis();
            whole.base.fit.chi2 = mended.base.fit.chi2.map(|chi2| times * chi2);
            whole
        };
        // Of 840 degrees of freedom 840 ln 1.27 is 200.8, and 840 ln 1.26 is 194.
        assert!(is_clearly_better(&mended, &leaving(1.27)));
        assert!(!is_clearly_better(&mended, &leaving(1.26)));
        let equally_weighted = Diagnosis { base: without_chi2(&mended), ..mended.clone() };
        assert!(!is_clearly_better(&mended, &equally_weighted));
        let kinds = [FaultKind::LevelPhase, FaultKind::ChannelSkew];
        assert!(kinds.iter().all(|kind| changes_all_alike(&MeasurementFault::of(*kind))));
        assert!(!changes_all_alike(&MeasurementFault::of(FaultKind::StdFactor)));
    }

    fn without_chi2(answer: &Diagnosis) -> crate::answers::Identification {
        let mut base = answer.base.clone();
        base.fit.chi2 = None;
        base
    }
}
