//! Cases that once had wrong answers, each with what was wrong.

use super::cases::{Case, Statement, Subject};

/// Every kept case.
pub fn cases() -> Vec<Case> {
    let ordinary = Case::ordinary;
    vec![
        // Called adequate: all of the response was left, a thousand times the stated noise.
        Case {
            subject: Subject::Noise,
            noise: 1.0,
            statement: Statement::Std(1e-3),
            magnitudes: vec![1.0, 2.0, 4.0],
            omegas: vec![1.0, 3.0, 10.0, 30.0],
            ..ordinary()
        },
        // A hardening spring was named from two numbers.
        Case {
            magnitudes: vec![1.0],
            omegas: vec![3.0],
            harmonics: vec![1],
            statement: Statement::Silent,
            ..ordinary()
        },
        // Called unexplained with residuals of rounding: no degree of freedom was left.
        Case { magnitudes: vec![1.0], omegas: vec![3.0], harmonics: vec![1], ..ordinary() },
        // The same with a third of the response left: the fit had missed the minimum that goes through
        // all data.
        Case {
            order: 2,
            magnitudes: vec![4.510812583921258],
            omegas: vec![41.35654115273845],
            harmonics: vec![0, 2, 4, 5],
            noise: 3.136405215302113e-5,
            digits: 3,
            decades: [-11, -1, -3],
            response: "position",
            seed: 76,
            ..ordinary()
        },
        // Parameters were determined to twelve digits from fewer numbers than there are parameters.
        Case { magnitudes: vec![1.0], omegas: vec![3.0], harmonics: vec![0, 1], ..ordinary() },
        // Panicked: the closed form divided by a friction of exactly 0.
        Case {
            subject: Subject::Linear,
            noise: 0.0,
            statement: Statement::Silent,
            harmonics: vec![1],
            magnitudes: (1..=8).map(f64::from).collect(),
            omegas: (1..=8).map(f64::from).collect(),
            ..ordinary()
        },
        // An infinite χ²: two repeats that are copies have no scatter.
        Case { statement: Statement::Repeats(2), noise: 0.0, ..ordinary() },
        // Panicked: sizes far from one.
        Case { decades: [0, 30, 0], ..ordinary() },
        Case { decades: [0, -30, 0], ..ordinary() },
        Case { decades: [0, 150, 0], ..ordinary() },
        Case { decades: [-300, 0, 0], ..ordinary() },
        Case { statement: Statement::Std(1e300), ..ordinary() },
        // A number of the answer was none.
        Case {
            subject: Subject::Linear,
            order: 1,
            magnitudes: vec![9.64609107153425, 39.93014982349439, 58.90635057349579],
            omegas: vec![40.900465858659544, 158.84006008673296, 713.1577409322988],
            harmonics: vec![0, 1, 2, 3, 4, 5],
            statement: Statement::Repeats(2),
            noise: 0.020118061411973098,
            decades: [-22, -10, -2],
            response: "acceleration",
            seed: 74,
            ..ordinary()
        },
        Case { omegas: vec![1e-6, 1e-3, 1.0, 1e3, 1e6], subject: Subject::Linear, ..ordinary() },
    ]
}
