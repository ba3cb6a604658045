//! The integration over one period, with or without derivatives.

use crate::effects::Axis;
use crate::plant::{Dual, Scalar as _};

use super::Periodic;
use crate::simulate::base::spectrum;
use crate::simulate::base::switching_times::Motion;
use crate::simulate::hybrid::integrate_period::PeriodIntegration;
use crate::simulate::hybrid::mechanics::{self, Mechanics};
use crate::simulate::hybrid::runge_kutta::Vector;
use crate::simulate::hybrid::sensitivity::Sensitivity;
use crate::simulate::piecewise_linear::drive::TorqueDerivatives;
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::fourier::Fourier;
use crate::simulate::signal::piecewise_quintic::PiecewiseQuintic;

/// Result of one period: the harmonics of v, and the residuals, which vanish for a periodic motion.
pub(in super::super) struct PeriodResult<const N: usize, const M: usize> {
    pub velocity: Vec<ComplexDual<Dual<N>>>,
    pub residuals: Vector<Dual<N>, M>,
}

impl<const M: usize> Periodic<M> {
    /// Integrates one period from the present state, without derivatives. Returns the state after
    /// it and the largest absolute values of the states.
    pub(super) fn integrate_plain(
        &mut self,
        mechanics: &Mechanics<f64>,
        forcing: &PiecewiseQuintic<f64>,
    ) -> Option<(Vector<f64, M>, [f64; M])> {
        let mut pass = PeriodIntegration {
            mechanics,
            forcing,
            precision: &self.precision,
            sums: None,
            companion: None,
            trace: None,
            largest: [0.0; M],
            swings: 0,
            effort: &mut self.effort,
        };
        let mut start = self.state;
        if let Some(i) = mechanics.position_integral {
            start[i] = 0.0;
        }
        let mut end = pass.run(&start)?;
        if let Some(i) = mechanics.position_integral {
            end[i] = self.state[i];
        }
        Some((end, pass.largest))
    }

    /// Integrates one period with derivatives. The first `parameters` lanes are those of the axis,
    /// the next ones the unknowns. Sums the Fourier integrals of v if `sums` is given.
    pub(super) fn follow<const N: usize>(
        &mut self,
        axis: &Axis<Dual<N>>,
        (forcing, torque): (&PiecewiseQuintic<f64>, &TorqueDerivatives),
        sums: Option<Fourier<'_, Dual<N>>>,
        parameters: usize,
    ) -> Option<PeriodResult<N, M>> {
        let mut mechanics = Mechanics::new(&axis.map(Dual::value));
        let mut lifted = Mechanics::new(axis);
        let unknown = |value: f64, lane: usize| {
            Dual::with_lanes(value, |l| f64::from(u8::from(l == parameters + lane)))
        };
        let mut start = self.state;
        let mut lanes: [[f64; N]; M] =
            std::array::from_fn(|i| std::array::from_fn(|lane| unknown(0.0, i).lane(lane)));
        if let Some(i) = mechanics.position_integral {
            mechanics.balance = self.state[i];
            lifted.balance = unknown(self.state[i], i);
            (start[i], lanes[i]) = (0.0, [0.0; N]);
        }
        let at_rest = mechanics.mode_at(forcing.cells[0].fixed(0.0), &start);
        if at_rest.motion == Motion::Stuck {
            (start[mechanics::VELOCITY], lanes[mechanics::VELOCITY]) = (0.0, [0.0; N]);
        }
        let mut sensitivity = Sensitivity::new(&lifted, (forcing, torque), sums, lanes);
        let mut pass = PeriodIntegration {
            mechanics: &mechanics,
            forcing,
            precision: &self.precision,
            sums: None,
            companion: Some(&mut sensitivity),
            trace: None,
            largest: [0.0; M],
            swings: 0,
            effort: &mut self.effort,
        };
        let end = pass.run(&start)?;
        let end = |i: usize| Dual::with_lanes(end[i], |lane| sensitivity.lanes[i][lane]);
        let residual = |i: usize| match mechanics.position_integral {
            Some(integral) if integral == i => end(i),
            _ => end(i) - unknown(self.state[i], i),
        };
        let residuals = std::array::from_fn(residual);
        let weighted = |(k, sum): (usize, ComplexDual<Dual<N>>)| {
            let scaled = sum.scaled(Dual::constant(spectrum::weight(k, forcing.period_s)));
            if k == 0 { ComplexDual::real(scaled.re) } else { scaled }
        };
        let sums = sensitivity.sums;
        let sums = sums.map(|sums| sums.finish().into_iter().enumerate().map(weighted).collect());
        Some(PeriodResult { velocity: sums.unwrap_or_default(), residuals })
    }
}
