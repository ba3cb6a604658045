"""Identifies g1 and g2 with the peers and with servoscope, seed by seed, and prints the tables."""

import argparse
import csv
import json
import statistics
import sys
import time
from collections import defaultdict
from pathlib import Path

import numpy as np

import emps
import ours
import peers
import simulator

TRUTH = {
    "g1": (0, [10.0, 10.0, 0.5, 0.4]),
    "g2": (2, [10.0, 10.0, 0.5, 0.4, 1000**0.5, 2.5 / 1000**0.5]),
}
NOISE_DB = 60
# Name, method, options. The last two show what the parts of abc-ann cost.
OURS = [
    ("abc-ann", "abc-ann", {}),
    ("least-squares", "least-squares", {}),
    ("cma-es", "cma-es", {}),
    ("abc-ann without its network", "abc-ann", {"network": {"enabled": False}}),
    ("abc-ann without network and colony", "abc-ann",
     {"network": {"enabled": False}, "colony": {"enabled": False}}),
]
REACHED = 1.0  # a cost this much above the least of all counts as reached: less than noise moves it


def settings(smoke):
    """Name, search, and whether K is solved for."""
    if smoke:
        few = (5, 10)
        return [
            ("mealpy ABC", peers.mealpy_abc(*few), False),
            ("pygmo bee colony", peers.pygmo_colony(*few), True),
            ("pyswarms", peers.swarm(*few), False),
            ("CMA-ES", peers.evolution(0, maxfevals=200), False),
            ("scipy least_squares", peers.least_squares(2), False),
            ("scipy differential_evolution", peers.differential_evolution(maxiter=2), False),
        ]
    paper = (peers.PAPER_SOURCES, peers.PAPER_CYCLES)
    long = (20, 500)
    return [
        ("mealpy ABC 10×50", peers.mealpy_abc(*paper), False),
        ("mealpy ABC 10×50, K solved", peers.mealpy_abc(*paper), True),
        ("mealpy ABC 20×500", peers.mealpy_abc(*long), False),
        ("mealpy ABC 20×500, K solved", peers.mealpy_abc(*long), True),
        ("pygmo bee colony 10×50", peers.pygmo_colony(*paper), False),
        ("pygmo bee colony 10×50, K solved", peers.pygmo_colony(*paper), True),
        ("pygmo bee colony 20×500", peers.pygmo_colony(*long), False),
        ("pygmo bee colony 20×500, K solved", peers.pygmo_colony(*long), True),
        ("pyswarms 20×50", peers.swarm(20, 50), False),
        ("pyswarms 40×300", peers.swarm(40, 300), False),
        ("CMA-ES", peers.evolution(0), False),
        ("CMA-ES, K solved", peers.evolution(0), True),
        ("scipy least_squares, 10 starts", peers.least_squares(10), False),
        ("scipy differential_evolution", peers.differential_evolution(), False),
    ]


COLONIES = ("mealpy ABC", "pygmo bee colony")
SOLVED = ", K solved"


def measured(name, seed):
    """A reference response with noise of its own for each seed, and the noise's deviation."""
    table = simulator.read_reference(name)
    std = float(np.median(np.abs(table.value[:, 1]))) * 10 ** (-NOISE_DB / 20)
    rng = np.random.default_rng([seed, len(table.omega)])
    noise = rng.normal(size=table.value.shape) + 1j * rng.normal(size=table.value.shape)
    noise[:, 0] = noise[:, 0].real
    table.value = table.value + std * noise
    return table, std


def write(table, std, path):
    with open(path, "w", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(["magnitude", "omega_rad_s", "harmonic", "re", "im", "std"])
        for magnitude, omega, harmonics in zip(table.magnitude, table.omega, table.value):
            for k, y in enumerate(harmonics):
                lines.writerow([magnitude, omega, k, y.real, y.imag, std])


def row(system, method, seed, misfit, axis, truth, **rest):
    errors = np.abs(np.array(axis) / np.array(truth) - 1)
    return {"system": system, "method": method, "seed": seed, "cost": misfit(axis),
            "axis": list(map(float, axis)), "errors": list(map(float, errors)), **rest}


def identifications(program, systems, seeds, smoke, folder):
    rows, unit = [], defaultdict(list)
    for seed in seeds:
        for system in systems:
            order, truth = TRUTH[system]
            table, std = measured(system, seed)
            file = folder / f"{system}.csv"
            write(table, std, file)
            misfit = simulator.Misfit(table, order, std)
            unit[system].append(ours.evaluation_s(program, file, order))
            for name, method, options in OURS:
                result, processor_s, wall_s = ours.identify(program, file, method, seed, order,
                                                            options)
                rows.append(row(system, name, seed, misfit, ours.axis(result), truth, ours=True,
                                processor_s=processor_s, wall_s=wall_s,
                                evaluations=ours.evaluations(result), stages=result["stages"]))
            for method, search, solve_gain in settings(smoke):
                objective = peers.Objective(table, order, std, solve_gain)
                begin, begin_wall = time.process_time(), time.perf_counter()
                cube = search(objective, seed)
                processor_s = time.process_time() - begin
                wall_s = time.perf_counter() - begin_wall
                rows.append(row(system, method, seed, misfit, objective.solved(cube), truth,
                                ours=False, processor_s=processor_s, wall_s=wall_s,
                                evaluations=objective.evaluations,
                                simulating_s=objective.simulating_s,
                                improvements=objective.improvements))
            print(f"seed {seed}, {system}: done", flush=True)
    return rows, {system: statistics.median(values) for system, values in unit.items()}


def add_reached(rows):
    """How far each cost is above the least of its system and seed, and when a peer came near it."""
    least = defaultdict(lambda: np.inf)
    for r in rows:
        least[r["system"], r["seed"]] = min(least[r["system"], r["seed"]], r["cost"])
    for r in rows:
        best = least[r["system"], r["seed"]]
        r["above"] = r["cost"] - best
        near = (n for n, cost in r.get("improvements", []) if cost <= best + REACHED)
        r["reached_at"] = next(near, None)


def runs_of(rows, system, method):
    return [r for r in rows if r["system"] == system and r["method"] == method]


def median(values):
    return statistics.median(values)


def spread(values, form):
    return f"{form(median(values))} ({form(min(values))}–{form(max(values))})"


def significant(value):
    """Two or three significant digits, without an exponent where that is short."""
    if value == 0:
        return "0"
    if value < 0.001 or value >= 1e5:
        return f"{value:.1e}"
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}" if value >= 1 else f"{value:.2g}"


def above(value):
    """A cost above the least: simulators differ by less than 0.001."""
    return "0" if value < 1e-3 else significant(value)


def table_of_methods(rows, system):
    grouped = defaultdict(list)
    for r in rows:
        if r["system"] == system:
            grouped[r["method"]].append(r)
    lines = [
        "| method | processor s | wall s | evaluations | χ² above the least of all | "
        "seeds within 1 | s until within 1 | largest parameter error, % |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for method, runs in grouped.items():
        name = f"**{method}**" if runs[0]["ours"] else method
        within = [r for r in runs if r["above"] <= REACHED]
        when = [r["processor_s"] * r["reached_at"] / r["evaluations"] for r in runs
                if r["reached_at"] is not None]
        cells = [
            name,
            spread([r["processor_s"] for r in runs], significant),
            significant(median([r["wall_s"] for r in runs])),
            spread([r["evaluations"] for r in runs], lambda n: f"{n:.0f}"),
            spread([r["above"] for r in runs], above),
            f"{len(within)} of {len(runs)}",
            "–" if runs[0]["ours"] or len(when) * 2 < len(runs) else significant(median(when)),
            spread([100 * max(r["errors"]) for r in runs], significant),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def table_of_errors(rows, system, names):
    lines = ["| method | " + " | ".join(names) + " |", "| --- |" + " --- |" * len(names)]
    for method in dict.fromkeys(r["method"] for r in rows):
        errors = [r["errors"] for r in rows if r["system"] == system and r["method"] == method]
        cells = [significant(100 * median(column)) for column in zip(*errors)]
        lines.append(f"| {method} | " + " | ".join(cells) + " |")
    return lines


def pairs(rows):
    """Peer and the method of ours beside it."""
    methods = dict.fromkeys(r["method"] for r in rows if not r["ours"])
    beside = {"mealpy": "abc-ann", "pygmo": "abc-ann", "pyswarms": "abc-ann", "CMA-ES": "cma-es",
              "scipy least_squares": "least-squares", "scipy differential": "abc-ann"}
    for method in methods:
        for beginning, own in beside.items():
            if method.startswith(beginning):
                yield method, own


def table_of_gains(rows, system, our_evaluation_s):
    """The ratio of processor times as a product: evaluations, time of one, and what is left, that is
    what a process does beside simulating. In the last column the peer's simulations are charged at
    the slowest rate that the comparison allows."""
    lines = [
        "| peer | ours | times faster | by evaluations | by the simulator | by what else is computed "
        "| seeds within 1 | computed: times faster at 0.1 ms a point |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    points = len(simulator.read_reference(system).omega)
    for peer, own in pairs(rows):
        theirs, mine = runs_of(rows, system, peer), runs_of(rows, system, own)
        their_s = median([r["processor_s"] for r in theirs])
        my_s = median([r["processor_s"] for r in mine])
        their_n = median([r["evaluations"] for r in theirs])
        my_n = median([r["evaluations"] for r in mine])
        their_unit = median([r["simulating_s"] / r["evaluations"] for r in theirs])
        total = their_s / my_s
        by_count, by_unit = their_n / my_n, their_unit / our_evaluation_s
        slow = their_s + their_n * (points * simulator.SLOWEST_POINT_S - their_unit)
        within = sum(r["above"] <= REACHED for r in theirs)
        cells = [peer, own, *(f"{v:.2g}" if v < 10 else f"{v:.0f}" for v in
                              (total, by_count, by_unit, total / (by_count * by_unit))),
                 f"{within} of {len(theirs)}", f"{slow / my_s:.0f}"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def table_of_stages(rows):
    """Where the time of servoscope goes, by the clock, as shares."""
    lines = ["| system | method | stage | evaluations | share of the time |",
             "| --- | --- | --- | --- | --- |"]
    for system, method in dict.fromkeys((r["system"], r["method"]) for r in rows if r["ours"]):
        runs = runs_of(rows, system, method)
        shares = defaultdict(list)
        for r in runs:
            for stage in r["stages"]:
                shares[stage["name"]].append((stage["evaluations"], stage["seconds"] / r["wall_s"]))
        for name, values in shares.items():
            count, share = (median(column) for column in zip(*values))
            lines.append(f"| {system} | {method} | {name} | {count:.0f} | {100 * share:.0f} % |")
        rest = median([1 - sum(s["seconds"] for s in r["stages"]) / r["wall_s"] for r in runs])
        lines.append(f"| {system} | {method} | all else: start, reading, intervals, printing | – | "
                     f"{100 * rest:.0f} % |")
    return lines


def targets(rows, systems):
    """The ratios of processor times that were aimed at: 100 for the colony, 20 for least squares."""

    def seconds(system, method):
        return median([r["processor_s"] for r in runs_of(rows, system, method)])

    def high(system, method):
        return median([r["above"] for r in runs_of(rows, system, method)])

    lines = []
    for system in systems:
        theirs = dict.fromkeys(r["method"] for r in rows
                               if r["system"] == system and not r["ours"])
        lines.append(f"{system}: abc-ann ends {above(high(system, 'abc-ann'))} above the least χ², "
                     f"the best peer {above(min(high(system, m) for m in theirs))}")
        colonies = [m for m in theirs if m.startswith(COLONIES)]
        good = [m for m in colonies if high(system, m) <= REACHED]
        kinds = {
            "the fastest colony, however high it ends": colonies,
            "the fastest colony within 1 of the least": good,
            "the fastest of these that searches every parameter":
                [m for m in good if not m.endswith(SOLVED)],
        }
        for kind, some in kinds.items():
            if some:
                fastest = min(some, key=lambda m: seconds(system, m))
                ratio = seconds(system, fastest) / seconds(system, "abc-ann")
                lines.append(f"{system}: abc-ann is {ratio:.1f} times as fast as {kind}: {fastest}")
        squares = next(m for m in theirs if m.startswith("scipy least"))
        ratio = seconds(system, squares) / seconds(system, "least-squares")
        lines.append(f"{system}: least-squares is {ratio:.1f} times as fast as {squares}")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path, help="the release binary of servoscope")
    parser.add_argument("--seeds", type=int, default=11)
    parser.add_argument("--smoke", action="store_true",
                        help="one seed and small budgets: that everything still runs")
    parser.add_argument("--only", nargs="+", choices=[*TRUTH, "emps"], default=[*TRUTH, "emps"])
    parser.add_argument("--results", type=Path, default=simulator.BUILD / "results.json")
    given = parser.parse_args()
    seeds = range(1, 2 if given.smoke else given.seeds + 1)
    systems = [system for system in TRUTH if system in given.only]
    simulator.BUILD.mkdir(parents=True, exist_ok=True)

    simulators = {}
    for system, (order, truth) in TRUTH.items():
        worst, point_s = simulator.check(system, order, truth)
        simulators[system] = [worst, point_s]
        print(f"the peers' simulator, {system}: off the reference by {worst:.1e} of its largest "
              f"component (at most {simulator.LARGEST_DEVIATION:.0e}), {point_s * 1e6:.1f} µs a "
              f"point (at most {simulator.SLOWEST_POINT_S * 1e6:.0f})", flush=True)
    deviation = simulator.check_motion("g1", TRUTH["g1"][1])
    print(f"the peers' simulator of motions: off by {deviation:.1e}", flush=True)
    start_s = ours.start_s(given.program)
    rows, unit = identifications(given.program, systems, seeds, given.smoke, simulator.BUILD)
    add_reached(rows)
    motions = []
    if "emps" in given.only and emps.is_there():
        unit["emps"] = statistics.median(
            ours.evaluation_s(given.program, emps.FILE, 0, 20, 200) for _ in seeds)
        motions = emps.compare(given.program, seeds, given.smoke)
    results = {"simulators": simulators, "start_s": start_s, "our_evaluation_s": unit,
               "rows": rows, "emps": motions}
    given.results.write_text(json.dumps(results))

    print(f"\nstart of a servoscope process: {start_s * 1e3:.0f} ms, counted in its figures")
    for system in systems:
        order = TRUTH[system][0]
        table = simulator.read_reference(system)
        points, names = len(table.omega), [r[0] for r in peers.ranges(table, order)]
        print(f"one evaluation of servoscope, {system}: {unit[system] * 1e6:.0f} µs, "
              f"{unit[system] / points * 1e6:.2f} µs a point")
        show(f"{system}: medians (smallest–largest), seeds: {len(seeds)}",
             table_of_methods(rows, system))
        show(f"{system}: where the gain comes from", table_of_gains(rows, system, unit[system]))
        show(f"{system}: errors of the parameters, %, medians",
             table_of_errors(rows, system, names))
    if motions:
        print(f"one evaluation of servoscope, EMPS: {unit['emps'] * 1e6:.0f} µs")
        show(f"EMPS: medians (smallest–largest), seeds: {len(seeds)}", emps.table(motions))
    with_stages = rows + [{**r, "system": "EMPS"} for r in motions]
    show("where the time of servoscope goes", table_of_stages(with_stages))
    show("targets", targets(rows, systems))
    high = [r for r in rows if r["ours"] and r["above"] > REACHED]
    for r in high:
        print(f"{r['system']}, seed {r['seed']}: {r['method']} ends {r['above']:.1f} too high")
    if high:
        sys.exit(1)


def show(title, lines):
    print(f"\n{title}\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
