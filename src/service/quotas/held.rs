//! What one key is held to, and whether what it has is beyond it.

use crate::store::Usage;

use super::Quotas;

/// Seconds after which to ask again for a place in the queue, and for time to compute.
const QUEUE_WAIT_S: u64 = 30;
const COMPUTE_WAIT_S: u64 = 1800;

/// Bytes of a mebibyte.
const MIB: i64 = 1 << 20;

/// What was used up, and how long to wait until there is room; `None`: nothing comes back by itself.
pub(super) type Exceeded = (String, Option<u64>);

/// The quotas of one key, and those that hold where it has none of its own.
#[derive(Debug, Clone, Copy)]
pub struct Held {
    pub(super) own: Quotas,
    pub(super) server: Quotas,
}

impl Held {
    /// How many there may be of something, and who says so.
    pub(super) fn most(
        &self,
        of: fn(&Quotas) -> Option<usize>,
        flag: &str,
    ) -> Option<(usize, String)> {
        let own = of(&self.own).map(|most| (most, "set for this key".to_owned()));
        own.or_else(|| of(&self.server).map(|most| (most, format!("`--key-{flag}`"))))
    }

    /// Whether what a key has must be counted.
    pub(super) fn counts(&self) -> bool {
        let counted =
            |quotas: Quotas| Quotas { requests_per_minute: None, ..quotas } != Quotas::default();
        counted(self.own) || counted(self.server)
    }

    /// Requests a minute, and who says so.
    pub fn requests_per_minute(&self) -> Option<(usize, String)> {
        self.most(|quotas| quotas.requests_per_minute, "requests-per-minute")
    }

    pub(super) fn exceeded_by_upload(&self, usage: &Usage) -> Option<Exceeded> {
        let kept = self.most(|quotas| quotas.measurements, "measurements");
        if let Some((most, by)) = kept.filter(|(most, _)| usage.measurements > *most as i64) {
            let measurements = if most == 1 { "measurement" } else { "measurements" };
            return Some((
                format!(
                    "has reached its limit of {most} {measurements} ({by}); delete what is not needed"
                ),
                None,
            ));
        }
        let mebibytes = (usage.bytes + MIB - 1) / MIB;
        let bytes = self.most(|quotas| quotas.mib, "mib");
        let (most, by) = bytes.filter(|(most, _)| mebibytes > *most as i64)?;
        Some((
            format!(
                "may keep {most} MiB of measurements ({by}), and with this one it would have {:.1} \
                 MiB; delete what is not needed",
                usage.bytes as f64 / MIB as f64
            ),
            None,
        ))
    }

    pub(super) fn exceeded_by_job(&self, usage: &Usage) -> Option<Exceeded> {
        let unfinished = self.most(|quotas| quotas.jobs, "jobs");
        if let Some((most, by)) = unfinished.filter(|(most, _)| usage.unfinished > *most as i64) {
            let jobs = if most == 1 { "job that waits or runs" } else { "jobs that wait or run" };
            return Some((
                format!(
                    "may have {most} {jobs} ({by}), and this job would exceed it; wait for others to finish"
                ),
                Some(QUEUE_WAIT_S),
            ));
        }
        let minutes = usage.computed_ms / 60_000;
        let computed = self.most(|quotas| quotas.compute_minutes, "compute-minutes");
        let (most, by) = computed.filter(|(most, _)| minutes >= *most as i64)?;
        let unit = if most == 1 { "minute" } else { "minutes" };
        Some((
            format!(
                "may compute {most} {unit} in 24 hours ({by}) and has used {minutes}; wait until some \
                 of that is more than 24 hours ago"
            ),
            Some(COMPUTE_WAIT_S),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Quotas = Quotas {
        measurements: None,
        mib: None,
        jobs: None,
        compute_minutes: None,
        requests_per_minute: None,
    };

    const USAGE: Usage =
        Usage { measurements: 3, bytes: 2 * MIB, unfinished: 2, computed_ms: 600_000 };

    fn of_server(server: Quotas) -> Held {
        Held { own: NONE, server }
    }

    #[test]
    fn what_is_just_within_a_quota_is_kept_and_what_is_beyond_is_not() {
        let of = |quotas: Quotas| {
            let held = of_server(quotas);
            [held.exceeded_by_upload(&USAGE), held.exceeded_by_job(&USAGE)]
                .map(|exceeded| exceeded.map(|(_, wait_s)| wait_s))
        };
        assert_eq!(of(NONE), [None, None]);
        assert_eq!(
            of(Quotas {
                measurements: Some(3),
                mib: Some(2),
                jobs: Some(2),
                compute_minutes: Some(11),
                requests_per_minute: Some(1),
            }),
            [None, None]
        );
        assert_eq!(of(Quotas { measurements: Some(2), ..NONE }), [Some(None), None]);
        assert_eq!(of(Quotas { mib: Some(1), ..NONE }), [Some(None), None]);
        assert_eq!(of(Quotas { jobs: Some(1), ..NONE }), [None, Some(Some(QUEUE_WAIT_S))]);
        let time = Quotas { compute_minutes: Some(10), ..NONE };
        assert_eq!(of(time), [None, Some(Some(COMPUTE_WAIT_S))]);
    }

    #[test]
    fn a_part_of_a_mebibyte_counts_as_one() {
        let beyond = Usage { bytes: 2 * MIB + 1, ..USAGE };
        let held = of_server(Quotas { mib: Some(2), ..NONE });
        let (text, _) = held.exceeded_by_upload(&beyond).unwrap();
        assert!(text.contains("2.0 MiB; delete"), "{text}");
    }

    #[test]
    fn what_is_set_for_a_key_holds_before_what_the_server_gives_every_key() {
        let server = Quotas { measurements: Some(2), jobs: Some(1), ..NONE };
        let held = Held { own: Quotas { measurements: Some(3), ..NONE }, server };
        assert_eq!(held.exceeded_by_upload(&USAGE), None);
        let (text, _) = held.exceeded_by_job(&USAGE).unwrap();
        assert!(text.contains("(`--key-jobs`)"), "{text}");
        let less = Held { own: Quotas { measurements: Some(1), ..NONE }, server };
        let (text, _) = less.exceeded_by_upload(&USAGE).unwrap();
        assert!(
            text.contains("has reached its limit of 1 measurement (set for this key)"),
            "{text}"
        );
        assert!(held.counts() && less.counts());
        assert!(!of_server(Quotas { requests_per_minute: Some(1), ..NONE }).counts());
    }
}
