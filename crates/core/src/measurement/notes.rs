//! How many remarks on a file are kept: a file may give rise to millions of them.

/// Most notes of a measurement.
const MOST: usize = 100;

/// Most bytes of all notes of a measurement.
const MOST_BYTES: usize = 16 << 10;

/// Most bytes of one note; a longer one is cut.
const LONGEST: usize = 1000;

/// What the last note may take.
const LAST: usize = 40;

/// The first notes within the limits; the last note then says how many there are beside them.
pub(super) fn cut(mut notes: Vec<String>) -> Vec<String> {
    notes.iter_mut().for_each(shorten);
    let bytes: usize = notes.iter().map(String::len).sum();
    if notes.len() <= MOST && bytes <= MOST_BYTES {
        return notes;
    }
    let mut left = MOST_BYTES - LAST;
    let fits = |note: &&String| match left.checked_sub(note.len()) {
        Some(rest) => {
            left = rest;
            true
        }
        None => false,
    };
    let kept = notes.iter().take(MOST - 1).take_while(fits).count();
    let more = notes.len() - kept;
    notes.truncate(kept);
    notes.push(format!("… and {more} more"));
    notes
}

fn shorten(note: &mut String) {
    if note.len() > LONGEST {
        note.truncate(note.floor_char_boundary(LONGEST - '…'.len_utf8()));
        note.push('…');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_cut_in_number_in_length_and_in_bytes_and_counted() {
        let few = vec!["one".to_owned(); MOST];
        assert_eq!(cut(few.clone()), few);
        let many = cut(vec!["one".to_owned(); 50_000]);
        assert_eq!((many.len(), many[MOST - 1].as_str()), (MOST, "… and 49901 more"));
        let long = cut(vec!["ö".repeat(5000); 50]);
        assert!(long.iter().all(|note| note.len() <= LONGEST && note.contains('…')));
        assert!(long.iter().map(String::len).sum::<usize>() <= MOST_BYTES);
        let (kept, last) = (long.len() - 1, long.last().expect("a last one"));
        assert_eq!(*last, format!("… and {} more", 50 - kept));
    }

    #[test]
    fn what_was_cut_is_not_cut_again() {
        for notes in [vec!["one".to_owned(); 50_000], vec!["ö".repeat(5000); 50]] {
            let once = cut(notes);
            assert_eq!(cut(once.clone()), once);
        }
    }
}
