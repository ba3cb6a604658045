//! Changes of valid files.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// Numbers at the edges, as text.
pub(super) const NUMBERS: [&str; 12] = [
    "1e308",
    "-1e308",
    "1e-320",
    "1e400",
    "1e999999999",
    "NaN",
    "inf",
    "-0",
    "9007199254740993",
    "99999999999999999999",
    "-1",
    "0.000000000000000000000000000000000000000001",
];

/// What opens a level of nesting in some format.
const OPENINGS: [&str; 6] = ["[", "{\"a\":", "(", "\"", "<c><v>", "# label.a: "];

/// One change of a file.
#[derive(Debug, Clone)]
pub(super) enum Mutation {
    /// Bits of a byte are flipped.
    Flip(Index, u8),
    /// The rest is cut off.
    Cut(Index),
    /// Some bytes are left out.
    Drop(Index, u8),
    /// What stands between two places is there twice.
    Double(Index, Index),
    /// Bytes are put in.
    Insert(Index, Vec<u8>),
    /// The number in a text that stands there or next is another.
    Number(Index, &'static str),
    /// A number of eight bytes is another.
    Word(Index, u64),
    /// So many levels are opened.
    Nest(Index, &'static str, u16),
}

/// Every kind of change, at any place.
pub(super) fn mutation() -> impl Strategy<Value = Mutation> {
    let words = vec![0, 1, u64::MAX, 1 << 31, 1 << 40, u64::from(u32::MAX), f64::MAX.to_bits()];
    prop_oneof![
        (any::<Index>(), 1..=255_u8).prop_map(|(at, bits)| Mutation::Flip(at, bits)),
        any::<Index>().prop_map(Mutation::Cut),
        (any::<Index>(), any::<u8>()).prop_map(|(at, count)| Mutation::Drop(at, count)),
        any::<[Index; 2]>().prop_map(|[from, to]| Mutation::Double(from, to)),
        (any::<Index>(), vec(any::<u8>(), 1..40)).prop_map(|(at, new)| Mutation::Insert(at, new)),
        (any::<Index>(), select(&NUMBERS[..])).prop_map(|(at, new)| Mutation::Number(at, new)),
        (any::<Index>(), select(words)).prop_map(|(at, new)| Mutation::Word(at, new)),
        (any::<Index>(), select(&OPENINGS[..]), 1..20_000_u16)
            .prop_map(|(at, opening, count)| Mutation::Nest(at, opening, count)),
    ]
}

impl Mutation {
    /// Changes a file.
    pub(super) fn apply(&self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        let length = bytes.len();
        match self {
            Self::Flip(at, bits) => bytes[at.index(length)] ^= bits,
            Self::Cut(at) => bytes.truncate(at.index(length)),
            Self::Drop(at, count) => {
                let from = at.index(length);
                bytes.drain(from..(from + usize::from(*count)).min(length));
            }
            Self::Double(from, to) => {
                let (from, to) = (from.index(length), to.index(length));
                let part = bytes[from.min(to)..from.max(to)].to_vec();
                bytes.splice(from.min(to)..from.min(to), part);
            }
            Self::Insert(at, new) => {
                let at = at.index(length);
                bytes.splice(at..at, new.iter().copied());
            }
            Self::Number(at, new) => {
                let is_digit = |byte: &u8| byte.is_ascii_digit();
                let from = at.index(length);
                let Some(begin) = bytes[from..].iter().position(is_digit) else { return };
                let begin = from + begin;
                let count = bytes[begin..].iter().take_while(|byte| is_digit(byte)).count();
                bytes.splice(begin..begin + count, new.bytes());
            }
            Self::Word(at, new) => {
                let from = at.index(length);
                let to = (from + 8).min(length);
                bytes.splice(from..to, new.to_le_bytes());
            }
            Self::Nest(at, opening, count) => {
                let at = at.index(length);
                bytes.splice(at..at, opening.repeat((*count).into()).into_bytes());
            }
        }
    }
}
