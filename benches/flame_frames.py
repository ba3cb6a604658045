#!/usr/bin/env python3
"""Shortens collapsed stacks to the functions of servoscope, and to what these call at last.

Of a name its last two parts are kept. Stacks in which the data are made are left out.
"""

import re
import sys


def short(frame):
    """Type and function, or module and function, without generic parameters and closures."""
    frame = re.sub(r"::\{\{closure\}\}|<impl .*>::|<_(, ?_)*>", "", frame)
    named = re.search(r"<(\S+?)[^:\w]* as .*>::(\w+)$", frame)
    frame = "::".join(named.groups()) if named else frame
    return "::".join(frame.replace("<S>", "").replace("servoscope_core::", "").split("::")[-2:])


for line in sys.stdin:
    stack, count = line.rsplit(" ", 1)
    frames = stack.split(";")
    own = [short(frame) for frame in frames if "servoscope_core::" in frame]
    own = [name for i, name in enumerate(own) if i == 0 or name != own[i - 1]]
    if not own or "servoscope_bench::machines" in stack:
        continue
    if re.match(r"\w+$", frames[-1]):
        own.append(frames[-1])
    print(";".join(own), count, end="")
