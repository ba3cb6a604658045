//! When a message that was not taken is sent again.

use std::time::Duration;

/// Seconds from one attempt of a webhook to the next: the schedule that Standard Webhooks
/// proposes, ten attempts in a little more than three days.
const WEBHOOK_S: [u32; 9] =
    [5, 300, 1800, 2 * 3600, 5 * 3600, 10 * 3600, 14 * 3600, 20 * 3600, 24 * 3600];

/// By how much a wait may be longer than it says, so that what failed together does not come
/// back together.
const JITTER: f64 = 0.2;

/// How long a broker is tried.
const BROKER_AGE: Duration = Duration::from_secs(3 * 24 * 3600);

/// Between two attempts at a broker, after the first two.
const BROKER_WAIT: Duration = Duration::from_secs(300);

/// How long to wait after so many attempts of a webhook; `None`: it is given up. `chance`
/// is a number from 0 to 1.
pub fn webhook_delay(attempts: u32, chance: f64) -> Option<Duration> {
    let seconds = WEBHOOK_S.get(attempts.checked_sub(1)? as usize)?;
    Some(Duration::from_secs_f64(f64::from(*seconds) * (1.0 + JITTER * chance)))
}

/// The same for a broker, of a message that is so old: there is only one, and it is the
/// operator's own, so that it is tried more often.
pub fn broker_delay(attempts: u32, age: Duration) -> Option<Duration> {
    let wait = if attempts <= 1 { Duration::from_secs(5) } else { BROKER_WAIT };
    (age < BROKER_AGE).then_some(wait)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_webhook_is_tried_ten_times_in_more_than_three_days() {
        let waits: Vec<Duration> =
            (1..).map_while(|attempts| webhook_delay(attempts, 0.0)).collect();
        assert_eq!(waits.len(), 9);
        assert_eq!(waits[0], Duration::from_secs(5));
        assert!(waits.is_sorted());
        assert!(waits.iter().sum::<Duration>() > Duration::from_secs(3 * 24 * 3600));
    }

    #[test]
    fn chance_makes_a_wait_longer_by_a_fifth_at_most() {
        assert_eq!(webhook_delay(2, 1.0), Some(Duration::from_secs(360)));
        assert_eq!(webhook_delay(2, 0.5), Some(Duration::from_secs(330)));
    }

    #[test]
    fn a_broker_is_tried_every_five_minutes_for_three_days() {
        let day = Duration::from_secs(24 * 3600);
        assert_eq!(broker_delay(1, Duration::ZERO), Some(Duration::from_secs(5)));
        assert_eq!(broker_delay(200, day), Some(Duration::from_secs(300)));
        assert_eq!(broker_delay(900, 3 * day), None);
    }
}
