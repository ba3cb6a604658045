"""servoscope as anybody runs it: one process an identification, on one thread."""

import json
import os
import subprocess
import time

THREADS = {"RAYON_NUM_THREADS": "1"}


def run(arguments):
    """Standard output, processor seconds (user and system, process start included), wall seconds."""
    begin = time.perf_counter()
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                               env={**os.environ, **THREADS})
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stdout.close()
    if process.returncode:
        raise RuntimeError(f"{' '.join(map(str, arguments))}: exit code {process.returncode}")
    return output, usage.ru_utime + usage.ru_stime, time.perf_counter() - begin


def identify(program, file, method, seed, order, options=None):
    """The result object of `servoscope identify`, processor and wall seconds."""
    arguments = [program, "identify", file, "--json", "--method", method, "--seed", str(seed),
                 "--actuator-order", str(order), "--options", json.dumps(options or {})]
    output, processor_s, wall_s = run(arguments)
    return json.loads(output), processor_s, wall_s


def axis(result):
    """Its parameters in the peers' order: a, K, Fc+, Fc-, and the actuator's."""
    value = {name: p["value"] for name, p in result["parameters"].items()}
    listed = [-value["pole"], value["constant"], value["fc_plus"], value["fc_minus"]]
    if "natural_frequency" in value:
        listed += [value["natural_frequency"], value["damping_ratio"]]
    return listed


def evaluations(result):
    return sum(stage["evaluations"] for stage in result["stages"])


def start_s(program):
    """Processor seconds of a process that has nothing to do."""
    return min(run([program, "--version"])[1] for _ in range(5))


def evaluation_s(program, file, order, few=50, many=1000):
    """Processor seconds of one evaluation: the difference of two colonies by that of their counts."""
    spent = []
    for cycles in (few, many):
        options = {"network": {"enabled": False}, "closed_form_start": False, "refine": False,
                   "colony": {"cycles": cycles}}
        result, processor_s, _ = identify(program, file, "abc-ann", 1, order, options)
        spent.append((evaluations(result), processor_s))
    return (spent[1][1] - spent[0][1]) / (spent[1][0] - spent[0][0])
