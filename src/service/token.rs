//! Keys as their holders know them.

use std::fmt;

use sha2::{Digest, Sha256};

use super::measurements::hexadecimal;

/// What a key begins with: programs that look for leaked keys find it by this.
const PREFIX: &str = "sk_servoscope_";

/// Bytes of the part by which a key is found.
const ID_BYTES: usize = 8;

/// Bytes of the part that nobody can guess.
const SECRET_BYTES: usize = 32;

/// Different bytes that the secret of a key from elsewhere has at least. Of 32 random bytes fewer
/// than 20 differ less than once in 10⁹ keys.
const DIFFERENT_BYTES: usize = 20;

/// A whole key, `sk_servoscope_ID_SECRET` with 16 and 64 hexadecimal digits. Only its holder has it;
/// the store has the id and the digest.
#[derive(Clone, PartialEq, Eq)]
pub struct Token {
    id: String,
    secret: String,
}

impl Token {
    /// A new one; `None` where the system has no random numbers.
    pub fn generate() -> Option<Self> {
        Self::with_id(&random::<ID_BYTES>()?)
    }

    /// A new one with the id of another; `None` where the system has no random numbers.
    pub(super) fn with_id(id: &str) -> Option<Self> {
        Some(Self { id: id.to_owned(), secret: random::<SECRET_BYTES>()? })
    }

    /// Reads a key; `None` for anything that cannot be one.
    pub fn parse(text: &str) -> Option<Self> {
        let (id, secret) = text.strip_prefix(PREFIX)?.split_once('_')?;
        let digits = |text: &str, bytes: usize| {
            let is_digit = |c: char| matches!(c, '0'..='9' | 'a'..='f');
            text.len() == 2 * bytes && text.chars().all(is_digit)
        };
        let whole = digits(id, ID_BYTES) && digits(secret, SECRET_BYTES);
        whole.then(|| Self { id: id.to_owned(), secret: secret.to_owned() })
    }

    /// Whether the secret may have come out of a generator of random numbers.
    pub(super) fn looks_random(&self) -> bool {
        let mut bytes: Vec<&[u8]> = self.secret.as_bytes().chunks(2).collect();
        bytes.sort_unstable();
        bytes.dedup();
        bytes.len() >= DIFFERENT_BYTES
    }

    /// The part by which it is found.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The whole key, for its holder.
    pub fn text(&self) -> String {
        format!("{PREFIX}{}_{}", self.id, self.secret)
    }

    /// Hexadecimal digest of the whole key, which is all that is stored of it.
    pub(super) fn sha256(&self) -> String {
        digest(&self.text())
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Token({PREFIX}{}_…)", self.id)
    }
}

/// Hexadecimal SHA-256 of a text. A secret of 32 random bytes needs no slow hash: it cannot be
/// guessed, however fast each guess is.
pub(super) fn digest(text: &str) -> String {
    hexadecimal(&Sha256::digest(text.as_bytes()))
}

/// So many random bytes in hexadecimal digits; `None` where the system has none.
pub(super) fn random<const BYTES: usize>() -> Option<String> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes).ok()?;
    Some(hexadecimal(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_made_here_can_be_read_again_and_is_no_other() {
        let token = Token::generate().unwrap();
        assert_eq!(Token::parse(&token.text()), Some(token.clone()));
        assert!(token.looks_random());
        assert_ne!(Token::generate().unwrap().id(), token.id());
        let other = Token::with_id(token.id()).unwrap();
        assert_eq!(other.id(), token.id());
        assert_ne!(other.sha256(), token.sha256());
    }

    #[test]
    fn what_cannot_be_a_key_is_none() {
        let id = "0123456789abcdef";
        let good = format!("sk_servoscope_{id}_{}", id.repeat(4));
        assert!(Token::parse(&good).is_some_and(|token| !token.looks_random()));
        for wrong in [
            String::new(),
            good.to_uppercase(),
            good.replace("sk_", "pk_"),
            format!("{good}0"),
            good[..good.len() - 1].to_owned(),
            good.replace("_0123", "_x123"),
            format!("sk_servoscope_{id}{id}"),
        ] {
            assert_eq!(Token::parse(&wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_digest_is_that_of_the_whole_key_and_the_secret_is_not_shown() {
        let token = Token { id: "ab".into(), secret: "cd".into() };
        // As `printf sk_servoscope_ab_cd | sha256sum` computes it.
        let known = "52d94ee67e39f9cc9fb527593979cc7bd936026cffedc22b8c48685d8d766567";
        assert_eq!(token.sha256(), known);
        assert_eq!(format!("{token:?}"), "Token(sk_servoscope_ab_…)");
    }
}
