#!/usr/bin/env python3
"""Prints the share of each part of a diagnosis, from the stacks of flame_frames.py.

A stack belongs to the first part one of whose functions is in it.
"""

import re
import sys

PARTS = [
    ("network of the base model", r"Network::|proposal::"),
    ("colony of the base model", r"bee_colony::|OverCube::|BeeColony::"),
    ("refinement of the base model, choice of its order", r"pipeline::|Run::|order::choose|solve::solve"),
    ("responses on the grid of every effect", r"Changes::of"),
    ("score tests and their limits", r"Changes::probe|Aim::|FamilywiseThreshold::|Subspace::|frequency_scan::"),
    ("short fits of effects", r"Fitter::tried"),
    ("full fits of effects", r"Fitter::|Search::shrink|FitSession::refine_watched"),
    ("comparison of models", r"from_rest|evidence::|::verified|OrderStudy::|order_study::"),
    ("faults of the measurement", r"Suspects::|course::|Scan::"),
    ("predictions of data held out", r"CrossValidation::|cross_validation::|::refit|LeavingOut::"),
    ("intervals", r"Profile::|solve::answer"),
    ("tests of residuals", r"discrepancy::|statistics::|Regions::|NoiseLaw::|variance_shrinkage::|Residuals::"),
]

shares = {name: 0 for name, _ in PARTS}
shares["simulations and others, whoever asked for them"] = 0
*_, rest = shares
for line in sys.stdin:
    stack, count = line.rsplit(" ", 1)
    of = (name for name, functions in PARTS if re.search(functions, stack))
    shares[next(of, rest)] += int(count)
total = sum(shares.values())
print("| part | share |\n| --- | --- |")
for name, share in sorted(shares.items(), key=lambda item: -item[1]):
    if share > 0.005 * total:
        print(f"| {name} | {100 * share / total:.0f} % |")
