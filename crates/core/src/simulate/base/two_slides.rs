//! The periodic motion under a cosine that slides once in each direction and never rests.
//!
//! Each slide begins where the one before ends with v = 0. These are two equations for the phases at
//! which the slides begin. `cosine` explains the normalisation.

use std::f64::consts::{PI, TAU};

use crate::plant::Friction;

/// Most steps of Newton's method; where there is a motion without rest, it needs three to five.
const MOST_STEPS: usize = 8;

/// The axis and its torque, free of units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Normalised {
    /// α = a/ω.
    pub alpha: f64,
    /// Coulomb friction forward, divided by |T|.
    pub c_plus: f64,
    /// … backward.
    pub c_minus: f64,
    /// Static friction forward, divided by |T|.
    pub s_plus: f64,
    /// … backward.
    pub s_minus: f64,
}

/// The beginning of a slide, and how much of a velocity is left at its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slide {
    /// sin φ at the beginning.
    pub sin: f64,
    /// cos φ at the beginning.
    pub cos: f64,
    /// w(φ) at the beginning: steady response of 1/(d/dφ + α) to cos φ.
    pub steady: f64,
    /// By how much φ grows during the slide.
    pub length: f64,
    /// E = exp(−α·length).
    pub kept: f64,
    /// 1 − E.
    pub lost: f64,
}

/// A motion that slides once forward and once backward in each period.
#[derive(Debug, Clone, Copy)]
pub(super) struct TwoSlides {
    pub forward: Slide,
    pub backward: Slide,
}

impl Normalised {
    /// With friction levels divided by the size of the torque.
    pub fn new(viscous_rate: f64, friction: &Friction, amplitude: f64, omega: f64) -> Self {
        Self {
            alpha: viscous_rate / omega,
            c_plus: friction.fc_plus / amplitude,
            c_minus: friction.fc_minus / amplitude,
            s_plus: friction.fs_plus / amplitude,
            s_minus: friction.fs_minus / amplitude,
        }
    }

    /// w(φ): steady response of the linear lag 1/(d/dφ + α) to cos φ.
    pub fn steady(&self, sin: f64, cos: f64) -> f64 {
        (self.alpha * cos + sin) / (self.alpha * self.alpha + 1.0)
    }

    /// The motion, if there is one without rest.
    ///
    /// With symmetric friction c the forward slide begins where w(φ) = −(c/α)·tanh(απ/2), with
    /// w = sin(φ + atan α)/√(1 + α²). Newton's method begins there, with the mean level.
    pub fn two_slides(&self) -> Option<TwoSlides> {
        let level = 0.5 * (self.c_plus + self.c_minus);
        let lost = lost_in(self.alpha * PI);
        let tanh = lost / (2.0 - lost);
        let length = (1.0 + self.alpha * self.alpha).sqrt();
        let sin = -level / self.alpha * tanh * length; // of φ + atan α
        if sin <= -1.0 {
            return None;
        }
        let cos = (1.0 - sin * sin).sqrt();
        self.two_slides_near((sin - self.alpha * cos) / length, (cos + self.alpha * sin) / length)
    }

    /// The same from another first guess: sine and cosine of the phase at which the forward slide
    /// begins. The backward one is taken to begin half a period later.
    pub fn two_slides_near(&self, sin: f64, cos: f64) -> Option<TwoSlides> {
        let (mut forward, mut backward) = ((sin, cos), (-sin, -cos));
        let mut length = PI;
        for _ in 0..MOST_STEPS {
            let slides = TwoSlides {
                forward: self.slide(forward, length),
                backward: self.slide(backward, TAU - length),
            };
            // z at the end of each slide, which must be 0.
            let ends = slides.solve(self, slides.ends(self));
            let (step_f, step_b) = (-ends[0], -ends[1]);
            let longest = step_f.abs().max(step_b.abs());
            if longest.is_nan() {
                return None;
            }
            // After a Newton step the error is of the order of the step squared.
            if longest < 1e-8 {
                let by = step_b - step_f;
                let settled = TwoSlides {
                    forward: slides.forward.moved(self, step_f, by),
                    backward: slides.backward.moved(self, step_b, -by),
                };
                return settled.is_possible(self).then_some(settled);
            }
            let damping = if longest > 0.5 { 0.5 / longest } else { 1.0 };
            forward = turned(forward, damping * step_f);
            backward = turned(backward, damping * step_b);
            length += damping * (step_b - step_f);
        }
        None
    }

    fn slide(&self, (sin, cos): (f64, f64), length: f64) -> Slide {
        let lost = lost_in(self.alpha * length);
        Slide { sin, cos, steady: self.steady(sin, cos), length, kept: 1.0 - lost, lost }
    }
}

impl Slide {
    /// Begun later by `change`, and longer by `longer`, both small, to first order.
    fn moved(self, axis: &Normalised, change: f64, longer: f64) -> Self {
        let Self { sin, cos, steady, length, kept, lost } = self;
        let decay = axis.alpha * longer * kept;
        Self {
            sin: sin + change * cos,
            cos: cos - change * sin,
            steady: steady + change * (cos - axis.alpha * steady),
            length: length + longer,
            kept: kept - decay,
            lost: lost + decay,
        }
    }
}

impl TwoSlides {
    /// Whether the torque exceeds the static level where each slide begins, and they take turns.
    fn is_possible(&self, axis: &Normalised) -> bool {
        let Self { forward, backward } = self;
        forward.cos > axis.s_plus
            && backward.cos < -axis.s_minus
            && forward.length > 0.0
            && backward.length > 0.0
    }

    /// z at the end of the forward and of the backward slide.
    fn ends(&self, axis: &Normalised) -> [f64; 2] {
        let Self { forward: f, backward: b } = self;
        [
            b.steady - f.steady * f.kept - axis.c_plus * f.lost / axis.alpha,
            f.steady - b.steady * b.kept + axis.c_minus * b.lost / axis.alpha,
        ]
    }

    /// The derivatives of [`Self::ends`] by α.
    pub fn ends_by_alpha(&self, axis: &Normalised) -> [f64; 2] {
        let Self { forward: f, backward: b } = self;
        let alpha = axis.alpha;
        // Of w, and of (1 − E)/α.
        let steady =
            |slide: &Slide| (slide.cos - 2.0 * alpha * slide.steady) / (1.0 + alpha * alpha);
        let lost = |slide: &Slide| (slide.length * slide.kept - slide.lost / alpha) / alpha;
        let carried = |slide: &Slide| (steady(slide) - slide.steady * slide.length) * slide.kept;
        [
            steady(b) - carried(f) - axis.c_plus * lost(f),
            steady(f) - carried(b) + axis.c_minus * lost(b),
        ]
    }

    /// The changes of the two phases that change [`Self::ends`] by `ends`, to first order.
    pub fn solve(&self, axis: &Normalised, ends: [f64; 2]) -> [f64; 2] {
        let Self { forward: f, backward: b } = self;
        let [[j11, j12], [j21, j22]] = [
            [-f.kept * (f.cos - axis.c_plus), b.cos - axis.c_plus],
            [f.cos + axis.c_minus, -b.kept * (b.cos + axis.c_minus)],
        ];
        let scale = 1.0 / (j11 * j22 - j12 * j21);
        [(ends[0] * j22 - ends[1] * j12) * scale, (ends[1] * j11 - ends[0] * j21) * scale]
    }
}

/// 1 − exp(−exponent).
pub(super) fn lost_in(exponent: f64) -> f64 {
    // Cheaper, and as exact where little cancels.
    if exponent > 0.5 { 1.0 - (-exponent).exp() } else { -(-exponent).exp_m1() }
}

/// (sin, cos) of a phase that grows by `change`.
fn turned((sin, cos): (f64, f64), change: f64) -> (f64, f64) {
    let (sin_change, cos_change) = match change * change {
        // The next terms of the series are below rounding.
        square if square < 1e-5 => (
            change * (1.0 - square / 6.0 * (1.0 - square / 20.0)),
            1.0 - square / 2.0 * (1.0 - square / 12.0),
        ),
        _ => change.sin_cos(),
    };
    (sin * cos_change + cos * sin_change, cos * cos_change - sin * sin_change)
}
