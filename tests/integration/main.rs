//! Integration tests.

mod measurements;
