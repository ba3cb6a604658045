//! The instruments whose tables are known: one file and one line each.

use super::instrument::Instrument;
use super::{bode_100, digilent, nf_fra};

/// All instruments.
const INSTRUMENTS: &[Instrument] =
    &[digilent::INSTRUMENT, bode_100::INSTRUMENT, nf_fra::INSTRUMENT];

/// The instrument whose columns have these names.
pub(super) fn find(names: &[String]) -> Option<&'static Instrument> {
    INSTRUMENTS.iter().find(|instrument| (instrument.is)(names))
}
