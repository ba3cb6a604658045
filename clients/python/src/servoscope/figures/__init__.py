"""Results as figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib import pyplot as plt

from ..errors import ServoscopeError
from . import bode, friction, residuals

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..results import Plot, Result

#: Width and height of each figure, inches.
_SIZES = {
    "overview": (13.0, 8.5),
    "bode": (7.5, 8.0),
    "residuals": (7.5, 4.5),
    "friction": (6.5, 4.2),
}


def draw(result: Result, kind: Plot) -> Figure:
    """Draw a figure of a result."""
    if kind not in _SIZES:
        raise ServoscopeError(f"there is no figure `{kind}`; there are {', '.join(_SIZES)}")
    figure = plt.figure(figsize=_SIZES[kind], layout="constrained")
    try:
        if kind == "overview":
            left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=(1.15, 1.0))[0]
            top, bottom = right.subfigures(2, 1, squeeze=False)[:, 0]
            bode.draw(left, result)
            residuals.draw(top, result)
            friction.draw(bottom, result)
        else:
            {"bode": bode, "residuals": residuals, "friction": friction}[kind].draw(figure, result)
    except ServoscopeError:
        plt.close(figure)
        raise
    # A notebook shows what a cell returns, and every open figure once more.
    if "inline" in mpl.get_backend():
        plt.close(figure)
    return figure
