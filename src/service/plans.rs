//! Plans of experiments, before anything is measured.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use servoscope_core::answers::{Plan, PlanOptions, PlanRequest, RoughAxis};
use servoscope_core::diagnose::{ExcitationKind, PlanError, excitation};

use super::inspections::{Gone, WhileWaiting};
use super::{Format, Service, ServiceError, aside};
use crate::report::figures::draw_plan;

/// What a plan is made for: an axis that is given, or that of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFor {
    /// A rough idea of the axis.
    pub axis: Option<RoughAxis>,
    /// A job whose result has the axis.
    pub job_id: Option<String>,
    /// Time for all experiments, s.
    pub budget_s: f64,
    /// Limits, noise and seed.
    pub options: PlanOptions,
}

impl Service {
    /// Plans experiments. It takes seconds, one plan at a time, and ends when the caller no longer waits. The
    /// same question has the same answer, which is kept for a while in memory; nothing is stored.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for what cannot be planned; [`ServiceError::TooCostly`];
    /// [`ServiceError::Busy`]; of the job as [`Service::result`].
    pub async fn plan(&self, question: PlanFor) -> Result<Arc<Plan>, ServiceError> {
        let axis = self.axis_of(&question).await?;
        let PlanFor { budget_s, options, .. } = question;
        let request = PlanRequest { axis, budget_s, options };
        self.check_plan(&request)?;
        let flag = Arc::new(AtomicBool::new(false));
        let _gone = Gone(Arc::clone(&flag));
        let key = format!("{request:?}");
        let place = self.places.long.take(&self.reach.owner).await?;
        if let Some(known) = self.asked.plans.get(&key) {
            return Ok(known);
        }
        let numerics = Arc::clone(&self.numerics);
        let planning =
            place.compute(move || numerics.plan(&request, &WhileWaiting(flag)).map_err(refused));
        let plan = Arc::new(planning.await?);
        self.asked.plans.keep(&key, Arc::clone(&plan));
        Ok(plan)
    }

    /// The input of a plan as CSV.
    ///
    /// # Errors
    /// As [`Service::plan`]; [`ServiceError::Request`] for an excitation that cannot be written.
    pub async fn plan_excitation(
        &self,
        question: PlanFor,
        kind: &str,
    ) -> Result<String, ServiceError> {
        let wrong = |reason: String| ServiceError::Request { member: "kind".into(), reason };
        let kind: ExcitationKind = kind.parse().map_err(wrong)?;
        let plan = self.plan(question).await?;
        let written = aside(move || excitation(&plan, kind)).await;
        written.map_err(|error| wrong(error.to_string()))
    }

    /// Draws a plan as an SVG document; `input_unit` is empty where it is not known.
    ///
    /// # Errors
    /// As [`Service::plan`].
    pub async fn plan_figure(
        &self,
        question: PlanFor,
        input_unit: &str,
        format: Format,
    ) -> Result<String, ServiceError> {
        let plan = self.plan(question).await?;
        Ok(draw_plan(&plan, input_unit, format))
    }

    async fn axis_of(&self, question: &PlanFor) -> Result<RoughAxis, ServiceError> {
        let wrong = |member: &str, reason: String| {
            Err(ServiceError::Request { member: member.into(), reason })
        };
        match (&question.axis, &question.job_id) {
            (Some(axis), None) => Ok(*axis),
            (None, Some(id)) => match RoughAxis::of(self.answer(id).await?.base()) {
                Ok(axis) => Ok(axis),
                Err(name) => wrong(
                    "job_id",
                    format!("its measurement does not determine `{name}`; give `axis` instead"),
                ),
            },
            (Some(_), Some(_)) => wrong("axis", "give `axis` or `job_id`, not both".into()),
            (None, None) => {
                wrong("axis", "give a rough idea of the axis, or `job_id` of a first result".into())
            }
        }
    }
}

fn refused(error: PlanError) -> ServiceError {
    let member = match &error {
        PlanError::Invalid { field, .. } => field,
        PlanError::TooShort { .. } => "budget_s",
        PlanError::NothingAllowed { .. } | PlanError::Cancelled => "options",
    };
    let reason = match &error {
        PlanError::Invalid { reason, .. } => reason.clone(),
        error => error.to_string(),
    };
    ServiceError::Request { member: member.to_owned(), reason }
}
