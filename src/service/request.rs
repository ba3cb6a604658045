//! What is asked of a job: from names and numbers to a request that can be run.

use serde::{Deserialize, Serialize};

use servoscope_bench::methods::METHODS;
use servoscope_core::answers::{IdentifyOptions, JobKind, Method, PlantRequest};
use servoscope_core::identify::IdentifyRequest;

use crate::store::Priority;

use super::ServiceError;

/// What a caller asks for, unchecked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Submission {
    /// Whoever asks: jobs of different submitters take turns.
    pub submitter: String,
    /// The measurement to work on.
    pub measurement_id: String,
    /// Kind of job.
    pub kind: String,
    /// Actuator order; `None`: chosen from the data.
    pub actuator_order: Option<u8>,
    /// Name of the method; `None`: the default.
    pub method: Option<String>,
    /// A second measurement, for kinds of job that use one.
    pub validation_measurement_id: Option<String>,
    /// Name of the priority; `None`: `normal`.
    pub priority: Option<String>,
    /// Options of the method.
    pub options: IdentifyOptions,
}

/// A request that can be run, every option in effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRequest {
    /// Kind of job.
    pub kind: JobKind,
    /// What is known of the plant; `None`: the order is chosen from the data.
    pub plant: Option<PlantRequest>,
    /// The method.
    pub method: Method,
    /// The measurement on which a diagnosis measures its gain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validation_measurement_id: Option<String>,
    /// Which jobs of the same submitter it goes before.
    #[serde(default)]
    pub priority: Priority,
    /// Its options.
    pub options: IdentifyOptions,
    /// What it is estimated to take, seconds of one processor; `None` for a job that an earlier
    /// version stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_s: Option<f64>,
}

impl JobRequest {
    /// Checks what a caller asks for.
    ///
    /// # Errors
    /// [`ServiceError::Request`] names the first member that cannot be used and
    /// lists what is known.
    pub fn check(submission: &Submission) -> Result<Self, ServiceError> {
        let kind = kind(&submission.kind)?;
        let plant = submission.actuator_order.map(plant).transpose()?;
        let method = match &submission.method {
            Some(name) => name.parse::<Method>()?,
            None => Method::default(),
        };
        if kind == JobKind::Diagnose && method == Method::TwoMagnitude {
            return Err(ServiceError::Request {
                member: "method".into(),
                reason: "`two-magnitude` fits nothing, and a diagnosis starts from a fit; take \
                         another method, or the kind `identify`"
                    .into(),
            });
        }
        let validation_measurement_id = second(submission, kind)?;
        let priority = submission.priority.as_deref().map(priority).transpose()?;
        submission.options.validate()?;
        Ok(Self {
            kind,
            plant,
            method,
            validation_measurement_id,
            priority: priority.unwrap_or_default(),
            options: submission.options,
            estimated_s: None,
        })
    }

    /// The same for the numeric core.
    pub fn identify(&self) -> IdentifyRequest {
        let Self { plant, method, options, .. } = *self;
        IdentifyRequest { plant, method, options, methods: METHODS, ..IdentifyRequest::default() }
    }
}

/// The second measurement, of a job that uses one.
fn second(submission: &Submission, kind: JobKind) -> Result<Option<String>, ServiceError> {
    let Some(id) = &submission.validation_measurement_id else { return Ok(None) };
    let reason = match kind {
        JobKind::Identify => {
            "an `identify` job uses no second measurement; leave it out and try the result on it \
             with `POST /v1/validations`"
        }
        JobKind::Diagnose if *id == submission.measurement_id => {
            "it is the measurement that is fitted: what is gained on it proves nothing; give \
             another one of the same axis"
        }
        JobKind::Diagnose => return Ok(Some(id.clone())),
    };
    let member = "validation_measurement_id".into();
    Err(ServiceError::Request { member, reason: reason.into() })
}

fn kind(name: &str) -> Result<JobKind, ServiceError> {
    match name {
        "identify" => Ok(JobKind::Identify),
        "diagnose" => Ok(JobKind::Diagnose),
        other => Err(ServiceError::Request {
            member: "kind".into(),
            reason: format!("`{other}` is not a kind of job; known: identify, diagnose"),
        }),
    }
}

fn priority(name: &str) -> Result<Priority, ServiceError> {
    let known = Priority::ALL.map(Priority::name);
    Priority::ALL.into_iter().find(|priority| priority.name() == name).ok_or_else(|| {
        ServiceError::Request {
            member: "priority".into(),
            reason: format!("`{name}` is not a priority; known: {}", known.join(", ")),
        }
    })
}

fn plant(actuator_order: u8) -> Result<PlantRequest, ServiceError> {
    if actuator_order <= 2 {
        return Ok(PlantRequest { actuator_order });
    }
    Err(ServiceError::Request {
        member: "plant.actuator_order".into(),
        reason: format!(
            "{actuator_order} is not an actuator order; known: 0, 1, 2 (left out: chosen from \
             the data)"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identify() -> Submission {
        Submission { kind: "identify".into(), ..Submission::default() }
    }

    fn refusal(submission: Submission) -> String {
        JobRequest::check(&submission).unwrap_err().to_string()
    }

    #[test]
    fn what_is_left_out_takes_its_default() {
        let request = JobRequest::check(&identify()).unwrap();
        assert_eq!(request.method, Method::AbcAnn);
        assert_eq!(request.options, IdentifyOptions::default());
        assert_eq!(request.plant, None);
    }

    #[test]
    fn an_unknown_method_is_refused_with_the_known_ones() {
        let text = refusal(Submission { method: Some("magic".into()), ..identify() });
        assert!(text.starts_with("method: `magic`") && text.contains("abc-ann"), "{text}");
    }

    #[test]
    fn a_diagnosis_by_a_method_that_fits_nothing_is_refused() {
        let with = |kind: &str| Submission {
            kind: kind.into(),
            method: Some("two-magnitude".into()),
            ..Submission::default()
        };
        assert_eq!(JobRequest::check(&with("identify")).unwrap().method, Method::TwoMagnitude);
        let text = refusal(with("diagnose"));
        assert!(text.starts_with("method: `two-magnitude` fits nothing"), "{text}");
    }

    #[test]
    fn an_unknown_order_is_refused_with_the_known_ones() {
        let text = refusal(Submission { actuator_order: Some(3), ..identify() });
        assert!(text.starts_with("plant.actuator_order: 3") && text.contains("0, 1, 2"), "{text}");
    }

    #[test]
    fn an_unknown_kind_is_refused_with_the_known_ones() {
        let diagnose = Submission { kind: "diagnose".into(), ..identify() };
        assert_eq!(JobRequest::check(&diagnose).unwrap().kind, JobKind::Diagnose);
        let text = refusal(Submission { kind: "divine".into(), ..identify() });
        assert!(text.contains("not a kind of job; known: identify, diagnose"), "{text}");
    }

    #[test]
    fn a_priority_is_one_of_three_and_normal_where_none_is_given() {
        let with = |name: &str| Submission { priority: Some(name.into()), ..identify() };
        assert_eq!(JobRequest::check(&identify()).unwrap().priority, Priority::Normal);
        assert_eq!(JobRequest::check(&with("high")).unwrap().priority, Priority::High);
        let text = refusal(with("urgent"));
        assert_eq!(text, "priority: `urgent` is not a priority; known: low, normal, high");
    }

    #[test]
    fn an_option_out_of_range_is_refused_by_its_name() {
        let mut options = IdentifyOptions::default();
        options.colony.food_sources = 1;
        let text = refusal(Submission { options, ..identify() });
        assert!(text.starts_with("options.colony.food_sources: 1"), "{text}");
    }

    #[test]
    fn a_second_measurement_is_for_a_diagnosis_of_another_one() {
        let with = |submission| Submission {
            measurement_id: "a".into(),
            validation_measurement_id: Some("b".into()),
            ..submission
        };
        let text = refusal(with(identify()));
        assert!(text.starts_with("validation_measurement_id: an `identify` job"), "{text}");
        let diagnose = with(Submission { kind: "diagnose".into(), ..Submission::default() });
        let request = JobRequest::check(&diagnose).unwrap();
        assert_eq!(request.validation_measurement_id.as_deref(), Some("b"));
        let text = refusal(Submission { measurement_id: "b".into(), ..diagnose });
        assert!(text.contains("proves nothing"), "{text}");
    }
}
