//! What friction is called in units of the input.

use servoscope_core::effects::Effort;

/// What friction is called where it is drawn in units of the input.
pub(super) fn friction(input_unit: &str) -> &'static str {
    match Effort::of(input_unit) {
        Effort::Force => "Friction force",
        Effort::Torque => "Friction torque",
        Effort::Other => "Friction",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_in_units_of_a_current_is_neither() {
        let named = ["N", "kN", "N·m", "mNm", "N m", "A", "", "%"].map(friction);
        let [force, torque] = ["Friction force", "Friction torque"];
        let other = "Friction";
        assert_eq!(named, [force, force, torque, torque, torque, other, other, other]);
    }
}
