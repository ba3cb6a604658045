//! What may be given beside a file, where it is one of few words. The service takes it as a text.

use utoipa::ToSchema;

/// In which loop an axis was measured.
#[derive(ToSchema)]
#[schema(rename_all = "lowercase")]
#[expect(dead_code, reason = "it describes a text")]
pub(super) enum LoopName {
    Open,
    Closed,
}

/// What amplitudes are.
#[derive(ToSchema)]
#[schema(rename_all = "kebab-case")]
#[expect(dead_code, reason = "it describes a text")]
pub(super) enum AmplitudeName {
    Peak,
    Rms,
    PeakToPeak,
}

/// Decimal mark of numbers.
#[derive(ToSchema)]
#[schema(rename_all = "lowercase")]
#[expect(dead_code, reason = "it describes a text")]
pub(super) enum DecimalName {
    Comma,
    Point,
}

/// Yes or no.
#[derive(ToSchema)]
#[schema(rename_all = "lowercase")]
#[expect(dead_code, reason = "it describes a text")]
pub(super) enum YesOrNo {
    Yes,
    No,
}
