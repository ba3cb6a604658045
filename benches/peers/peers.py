"""The peers: searches of other packages, each as a competent user would set it.

A peer is a function of an objective and a seed. It returns the best point of the unit cube. The
objective counts what it is asked.
"""

import time
import warnings

import cma
import numpy as np
import pygmo
import pyswarms
import scipy.optimize
from mealpy import FloatVar
from mealpy.swarm_based.ABC import OriginalABC

from simulator import Misfit

PAPER_SOURCES, PAPER_CYCLES = 10, 50


def ranges(table, order):
    """Name, scale and ends of the range of each parameter.

    These are the ranges that servoscope searches: it takes them from the frequencies and from the
    lowest magnitude that moves the axis. It does not search K; the peers get the range of a for it.
    """
    low, high = table.omega.min(), table.omega.max()
    level = table.magnitude.min()
    rate = ("log", low / 3, high * 3)
    listed = [("a", *rate), ("K", *rate), ("Fc+", "linear", 0.0, level), ("Fc-", "linear", 0.0, level)]
    if order == 2:
        listed += [("wn", "log", low, high * 5), ("zeta", "log", 0.02, 2.0)]
    return listed


class Objective:
    """Chi-square, or the residuals, over the unit cube. Counts evaluations and their time.

    With `solve_gain`, K is not searched: the response is proportional to it, so that its best value
    is a projection. That is what servoscope's searches do.
    """

    def __init__(self, table, order, std, solve_gain=False):
        self.misfit = Misfit(table, order, std)
        listed = ranges(table, order)
        searched = [r for r in listed if not (solve_gain and r[0] == "K")]
        self.solve_gain = solve_gain
        self.names = [r[0] for r in listed]
        self.log = np.array([r[1] == "log" for r in searched])
        ends = np.array([[r[2], r[3]] for r in searched])
        ends[self.log] = np.log(ends[self.log])
        self.low, self.width = ends[:, 0], ends[:, 1] - ends[:, 0]
        self.dimension = len(searched)
        self.start()

    def start(self):
        self.evaluations, self.simulating_s = 0, 0.0
        self.best = np.inf
        self.improvements = []  # (evaluations, cost)

    def axis(self, cube):
        """Parameters in natural units; K is 1 where it is solved for."""
        value = self.low + self.width * np.asarray(cube, dtype=float)
        value[self.log] = np.exp(value[self.log])
        return np.insert(value, 1, 1.0) if self.solve_gain else value

    def solved(self, cube):
        """The same with K solved for."""
        axis = self.axis(cube)
        if self.solve_gain:
            axis[1] = self._gain(self.misfit.response(axis))
        return axis

    def _gain(self, unit):
        size = np.vdot(unit, unit).real
        return max(np.vdot(unit, self.misfit.table.value).real / size, 1e-6) if size > 0 else 1e-6

    def __call__(self, cube):
        begin = time.process_time()
        axis = self.axis(cube)
        if self.solve_gain:
            unit = self.misfit.response(axis)
            left = self._gain(unit) * unit - self.misfit.table.value
            cost = np.vdot(left, left).real / self.misfit.std**2
        else:
            cost = self.misfit(axis)
        self._count(begin, cost)
        return cost

    def residuals(self, cube):
        begin = time.process_time()
        left = self.misfit.residuals(self.axis(cube))
        self._count(begin, left @ left)
        return left

    def _count(self, begin, cost):
        self.simulating_s += time.process_time() - begin
        self.evaluations += 1
        if cost < self.best:
            self.best = cost
            self.improvements.append((self.evaluations, cost))


def mealpy_abc(sources, cycles):
    def search(objective, seed):
        problem = {
            "obj_func": objective,
            "bounds": FloatVar(lb=[0.0] * objective.dimension, ub=[1.0] * objective.dimension),
            "minmax": "min",
            "log_to": None,
        }
        limit = sources * objective.dimension
        model = OriginalABC(epoch=cycles, pop_size=sources, n_limits=limit)
        return model.solve(problem, seed=seed).solution

    return search


class _PygmoProblem:
    """A problem as pygmo wants it. It copies problems, but the objective must stay one."""

    def __init__(self, objective):
        self.objective = objective

    def __deepcopy__(self, memo):
        return _PygmoProblem(self.objective)

    def fitness(self, cube):
        return [self.objective(cube)]

    def get_bounds(self):
        return [0.0] * self.objective.dimension, [1.0] * self.objective.dimension


def pygmo_colony(sources, cycles):
    def search(objective, seed):
        problem = pygmo.problem(_PygmoProblem(objective))
        limit = sources * objective.dimension
        colony = pygmo.algorithm(pygmo.bee_colony(gen=cycles, limit=limit, seed=seed))
        return colony.evolve(pygmo.population(problem, size=sources, seed=seed)).champion_x

    return search


def swarm(particles, iterations):
    def search(objective, seed):
        np.random.seed(seed)
        # Clerc and Kennedy's constriction, the values of PSO textbooks.
        weights = {"c1": 1.49618, "c2": 1.49618, "w": 0.7298}
        bounds = np.zeros(objective.dimension), np.ones(objective.dimension)
        best = pyswarms.single.GlobalBestPSO(particles, objective.dimension, weights, bounds=bounds)

        def costs(cubes):
            return np.array([objective(cube) for cube in cubes])

        return best.optimize(costs, iterations, verbose=False)[1]

    return search


def evolution(restarts, **options):
    """CMA-ES from a random point, the population doubled at each restart."""

    def search(objective, seed):
        # The seed 0 of this package is the clock.
        settings = {"bounds": [0, 1], "seed": seed + 1, "verbose": -9, **options}
        start = np.random.default_rng(seed).uniform(size=objective.dimension)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = cma.fmin2(objective, start, 0.3, settings, restarts=restarts, incpopsize=2)
        return found[1].result.xbest

    return search


def least_squares(starts):
    """Trust-region reflective from uniform starts, derivatives by differences."""

    def search(objective, seed):
        rng = np.random.default_rng(seed)
        found = [
            scipy.optimize.least_squares(objective.residuals, start, bounds=(0, 1))
            for start in rng.uniform(size=(starts, objective.dimension))
        ]
        return min(found, key=lambda result: result.cost).x

    return search


def differential_evolution(**options):
    """The defaults: 15 members a parameter, until they agree, then L-BFGS-B."""

    def search(objective, seed):
        bounds = [(0, 1)] * objective.dimension
        return scipy.optimize.differential_evolution(objective, bounds, rng=seed, **options).x

    return search
