//! The result of a job as it is sent: what was stored, and what it comes to in one sentence.

use crate::report;

use super::jobs::answer;
use super::{Service, ServiceError};

impl Service {
    /// The result of a job: the JSON that was stored, every digit of it, and as its last member
    /// `headline`, the verdict in one sentence. What this version cannot read has none.
    ///
    /// # Errors
    /// As [`Service::result`].
    pub async fn result_with_headline(&self, id: &str) -> Result<String, ServiceError> {
        Ok(with_headline(self.result(id).await?))
    }
}

fn with_headline(result: String) -> String {
    let (Ok(answer), Some(members)) = (answer(&result), result.trim_end().strip_suffix('}')) else {
        return result;
    };
    let headline = serde_json::Value::from(report::headline(&answer));
    format!("{members},\"headline\":{headline}}}")
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{Answer, sample};

    use super::*;

    #[test]
    fn a_result_is_sent_as_it_was_stored_with_its_headline_behind() {
        let answer = Answer::from(sample::explained());
        let stored = serde_json::to_string(&answer).unwrap();
        let sent = with_headline(stored.clone());
        assert!(sent.starts_with(stored.strip_suffix('}').unwrap()), "{sent}");
        let read: serde_json::Value = serde_json::from_str(&sent).unwrap();
        let headline = read["headline"].as_str().unwrap();
        assert!(headline.starts_with("EXPLAINED: The simulation lacks"), "{headline}");
        assert_eq!(Answer::from_json(&sent).unwrap(), answer, "it is a result as before");
    }

    #[test]
    fn a_result_of_another_version_is_sent_as_it_was_stored() {
        for stored in ["{\"a\":1}", "{}", "[]", "what nobody reads"] {
            assert_eq!(with_headline(stored.into()), stored);
        }
    }
}
