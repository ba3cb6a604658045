"""The peers' simulator: axis.c, compiled when it is first needed, and what it says of itself."""

import csv
import ctypes
import os
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
REFERENCE = HERE.parent.parent / "tests" / "reference"
BUILD = Path(os.environ.get("PEERS_BUILD", HERE.parent.parent / "target" / "peers"))

LARGEST_DEVIATION = 1e-5  # of the largest component of a reference file
SLOWEST_POINT_S = 1e-4


def _library():
    source, library = HERE / "axis.c", BUILD / "axis.so"
    if not library.exists() or library.stat().st_mtime < source.stat().st_mtime:
        BUILD.mkdir(parents=True, exist_ok=True)
        compiler = os.environ.get("CC", "cc")
        flags = ["-O3", "-march=native", "-std=gnu11", "-Wall", "-shared", "-fPIC"]
        subprocess.run([compiler, *flags, source, "-o", library, "-lm"], check=True)
    built = ctypes.CDLL(str(library))
    built.design_residuals.restype = ctypes.c_double
    built.motion.restype = ctypes.c_double
    return built


_AXIS = _library()


def _pointer(array):
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


@dataclass
class Table:
    """Harmonics of a design of points: value[point, harmonic]."""

    magnitude: np.ndarray
    omega: np.ndarray
    value: np.ndarray

    @property
    def highest(self):
        return self.value.shape[1] - 1


def read_reference(name):
    """A reference response, noise-free, of tests/reference."""
    with open(REFERENCE / f"{name}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    points = {}
    for row in rows:
        harmonics = points.setdefault((float(row["magnitude"]), float(row["omega_rad_s"])), {})
        harmonics[int(row["harmonic"])] = complex(float(row["re"]), float(row["im"]))
    value = [[h[k] for k in range(len(h))] for h in points.values()]
    magnitude, omega = (np.array(column) for column in zip(*points))
    return Table(magnitude, omega, np.array(value))


class Misfit:
    """Sum of squares (chi-square) of a table with noise of deviation `std` in each component.

    Parameters are in natural units: a, K, Fc+, Fc-, and the actuator's.
    """

    def __init__(self, table, order, std):
        self.table, self.order, self.std = table, order, std
        self.points = len(table.omega)
        self._measured = np.ascontiguousarray(table.value).view(float).ravel().copy()
        self._out = np.empty_like(self._measured)
        self._fixed = (order, self.points, _pointer(table.magnitude), _pointer(table.omega),
                       table.highest)

    def __call__(self, axis):
        axis = np.ascontiguousarray(axis, dtype=float)
        return _AXIS.design_residuals(_pointer(axis), *self._fixed, _pointer(self._measured),
                                      ctypes.c_double(self.std), _pointer(self._out))

    def residuals(self, axis):
        self(axis)
        return self._out.copy()

    def response(self, axis):
        axis = np.ascontiguousarray(axis, dtype=float)
        out = np.empty_like(self._measured)
        if _AXIS.design_response(_pointer(axis), *self._fixed, _pointer(out)):
            raise ArithmeticError(f"no periodic response at {axis}")
        return out.view(complex).reshape(self.table.value.shape)


def motion(axis, dt, force, position, velocity=0.0):
    """Positions under a sampled force, from a position and a velocity; and the velocity at the end."""
    a, k, plus, minus = (ctypes.c_double(value) for value in axis)
    out = np.empty(len(force))
    out[0] = position
    force = np.ascontiguousarray(force)
    end = _AXIS.motion(a, k, plus, minus, len(force), ctypes.c_double(dt), _pointer(force),
                       ctypes.c_double(velocity), _pointer(out))
    return out, end


def check(name, order, axis, repeats=200):
    """Deviation from a reference response and processor time a point; raises where it is too much."""
    table = read_reference(name)
    misfit = Misfit(table, order, 1.0)
    deviation = np.abs(misfit.response(axis) - table.value)
    worst = deviation.max() / np.abs(table.value).max()
    begin = time.process_time()
    for _ in range(repeats):
        misfit(axis)
    point_s = (time.process_time() - begin) / repeats / misfit.points
    if worst > LARGEST_DEVIATION or point_s > SLOWEST_POINT_S:
        raise AssertionError(f"{name}: off by {worst:.1e}, {point_s * 1e6:.1f} us a point")
    return worst, point_s


def check_motion(name, axis, samples=4000, periods=4):
    """The same of motions: under a sampled cosine, what is left of the first harmonic of position."""
    table = read_reference(name)
    i = np.flatnonzero((table.magnitude == 2) & (table.omega > 5))[0]
    m, w = table.magnitude[i], table.omega[i]
    dt = 2 * np.pi / w / samples
    angle = w * dt * np.arange(periods * samples + 1)
    position, _ = motion(axis, dt, m * np.cos(angle), 0.0)
    last = slice(-samples - 1, -1)
    drift = (position[-1] - position[-samples - 1]) / samples * np.arange(samples)
    first = 2 * np.mean((position[last] - drift) * np.exp(-1j * angle[last]))
    expected = table.value[i, 1] / (1j * w)
    deviation = abs(first / expected - 1)
    if deviation > LARGEST_DEVIATION:
        raise AssertionError(f"{name}: a motion is off by {deviation:.1e}")
    return deviation
