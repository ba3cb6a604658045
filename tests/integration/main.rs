//! Integration tests: everything through the public interface.

mod simulation;
