"""EMPS: the physical parameters by the error of the simulated position, fitted by scipy, and by
servoscope.

    M q'' = F - Fv q' - Fc sign(q') - offset

The sign is set-valued at rest. In servoscope's terms a = Fv/M, K = 1/M, Fc+ = Fc + offset and
Fc- = Fc - offset.
"""

import csv
import os
import statistics
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import scipy.optimize

import ours
from simulator import HERE, motion

DATA = Path(os.environ.get("SERVO_DATA_DIR", HERE.parent.parent.parent / "shared" / "data"))
FILE = DATA / "emps" / "emps.csv"
PERIOD = 6240  # samples
# Of mass, viscous and Coulomb friction, and offset; mass and viscous friction are searched as logarithms.
LOW = np.array([np.log(10.0), np.log(10.0), 0.0, -20.0])
HIGH = np.array([np.log(1000.0), np.log(1000.0), 60.0, 20.0])
STARTS = 10  # as many as servoscope's least-squares has


class Record:
    def __init__(self, path):
        with open(path) as file:
            lines = csv.reader(line for line in file if not line.startswith("#"))
            next(lines)
            self.time, self.force, self.position = np.array([list(map(float, l)) for l in lines]).T
        self.dt = (self.time[-1] - self.time[0]) / (len(self.time) - 1)
        # The mean of the last whole periods, as servoscope takes it.
        count = len(self.force) // PERIOD
        last = slice(len(self.force) - count * PERIOD, None)
        self.mean_force = self.force[last].reshape(count, PERIOD).mean(axis=0)
        self.mean_position = self.position[last].reshape(count, PERIOD).mean(axis=0)

    def whole(self, physical):
        """Simulated less measured position over the record, started at rest where it begins."""
        simulated, _ = motion(axis(physical), self.dt, self.force, self.position[0])
        return simulated - self.position

    def periodic(self, physical, with_drift=True):
        """The same for the periodic motion under the mean period of the force, less what a constant
        explains. Without the drift over a period this is what the position's harmonics miss."""
        force = np.append(self.mean_force, self.mean_force[0])
        velocity = 0.0
        for _ in range(4):
            simulated, velocity = motion(axis(physical), self.dt, force, 0.0, velocity)
        drift = 0 if with_drift else simulated[-1] / PERIOD * np.arange(PERIOD)
        left = simulated[:-1] - drift - self.mean_position
        return left - left.mean()

    def shares(self, physical):
        """What is left of the position, of the record and of the mean period (NRMSE)."""
        return (np.linalg.norm(self.whole(physical)) / size(self.position),
                np.linalg.norm(self.periodic(physical, False)) / size(self.mean_position))


def size(position):
    return np.linalg.norm(position - position.mean())


def axis(physical):
    mass, viscous, coulomb, offset = physical
    return viscous / mass, 1 / mass, max(coulomb + offset, 0.0), max(coulomb - offset, 0.0)


def physical_of(own):
    a, k, plus, minus = own
    return [1 / k, a / k, (plus + minus) / 2, (plus - minus) / 2]


def fit(error, seed, starts):
    """Trust-region least squares from uniform starts. Returns the parameters and evaluations."""
    count = 0

    def residuals(point):
        nonlocal count
        count += 1
        return error(natural(point))

    def natural(point):
        return [np.exp(point[0]), np.exp(point[1]), point[2], point[3]]

    rng = np.random.default_rng(seed)
    found = [
        scipy.optimize.least_squares(residuals, start, bounds=(LOW, HIGH), x_scale=(HIGH - LOW) / 4)
        for start in rng.uniform(LOW, HIGH, size=(starts, len(LOW)))
    ]
    return natural(min(found, key=lambda result: result.cost).x), count


def is_there():
    if not FILE.exists():
        print(f"SKIPPED: no {FILE}; SERVO_DATA_DIR says where the measured data is", flush=True)
    return FILE.exists()


def compare(program, seeds, smoke):
    record = Record(FILE)
    rows = []

    def add(method, seed, physical, evaluations, processor_s, wall_s, stages=None):
        whole, periodic = record.shares(physical)
        rows.append({"method": method, "seed": seed, "processor_s": processor_s, "wall_s": wall_s,
                     "evaluations": evaluations, "whole": whole, "periodic": periodic,
                     "physical": list(map(float, physical)), "ours": stages is not None,
                     "stages": stages})

    errors = [("scipy least_squares, whole record", record.whole),
              ("scipy least_squares, mean period", record.periodic),
              ("scipy least_squares, mean period without drift",
               lambda physical: record.periodic(physical, False))]
    for seed in seeds:
        for method in ("abc-ann", "least-squares"):
            for weights in ("noise", "response"):
                result, processor_s, wall_s = ours.identify(
                    program, FILE, method, seed, 0, {"weights": weights})
                add(f"{method}, weights by {weights}", seed, physical_of(ours.axis(result)),
                    ours.evaluations(result), processor_s, wall_s, result["stages"])
        for method, error in errors:
            begin, begin_wall = time.process_time(), time.perf_counter()
            physical, count = fit(error, seed, 1 if smoke else STARTS)
            add(method, seed, physical, count, time.process_time() - begin,
                time.perf_counter() - begin_wall)
        print(f"seed {seed}, EMPS: done", flush=True)
    return rows


def table(rows):
    grouped = defaultdict(list)
    for r in rows:
        grouped[r["method"]].append(r)
    lines = [
        "| method | processor s | wall s | evaluations | left of the record, % | "
        "left of the mean period, % | mass, kg | viscous, N·s/m | Coulomb, N | offset, N |",
        "| --- |" + " --- |" * 9,
    ]
    for method, runs in grouped.items():
        columns = {key: [r[key] for r in runs] for key in runs[0]}
        spent = columns["processor_s"]
        physical = [statistics.median(values) for values in zip(*columns["physical"])]
        cells = [
            f"**{method}**" if runs[0]["ours"] else method,
            f"{statistics.median(spent):.2f} ({min(spent):.2f}–{max(spent):.2f})",
            f"{statistics.median(columns['wall_s']):.2f}",
            f"{statistics.median(columns['evaluations']):.0f}",
            f"{100 * statistics.median(columns['whole']):.2f}",
            f"{100 * statistics.median(columns['periodic']):.2f}",
            *(f"{value:.{digits}f}" for value, digits in zip(physical, (1, 1, 2, 2))),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines
