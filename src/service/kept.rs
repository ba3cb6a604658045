//! Answers that are kept for a while, so that the same question need not be computed again.

use std::sync::{Mutex, PoisonError};

/// At most so many answers by their questions; the oldest makes room.
pub(super) struct Kept<T> {
    most: usize,
    known: Mutex<Vec<(String, T)>>,
}

impl<T: Clone> Kept<T> {
    pub(super) fn new(most: usize) -> Self {
        Self { most, known: Mutex::default() }
    }

    pub(super) fn get(&self, question: &str) -> Option<T> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.iter().find(|(of, _)| of == question).map(|(_, answer)| answer.clone())
    }

    pub(super) fn keep(&self, question: &str, answer: T) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|(of, _)| of != question);
        known.push((question.to_owned(), answer));
        let surplus = known.len().saturating_sub(self.most);
        known.drain(..surplus);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_answer_makes_room() {
        let kept = Kept::new(2);
        for question in ["a", "b", "c"] {
            kept.keep(question, question.to_uppercase());
        }
        assert_eq!(kept.get("a"), None);
        assert_eq!(kept.get("b").as_deref(), Some("B"));
        kept.keep("b", "new".to_owned());
        assert_eq!(kept.get("b").as_deref(), Some("new"));
        assert_eq!(kept.get("c").as_deref(), Some("C"));
    }
}
