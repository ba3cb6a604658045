"""Friction over velocity, as the models have it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..comparison import Quantities
from ..errors import ServoscopeError
from .parts import NAMES, Canvas, with_unit

if TYPE_CHECKING:
    from ..comparison import Floats
    from ..results import Identification, Result

_STYLES = {"base": ("--", "C7"), "extended": ("-", "C0")}


def draw(canvas: Canvas, result: Result) -> None:
    """Draw the force or torque that each model needs to move at a constant velocity."""
    axes = canvas.subplots()
    comparison = result.comparison
    reach = comparison.fastest() if comparison else 0.0
    speed = np.linspace(0.0, 1.0, 400) * (reach or _guess(result.model))
    for name, model in result.models.items():
        style, colour = _STYLES[name]
        velocity = np.concatenate([-speed[::-1], speed])
        drawn = np.concatenate([torque(model, -1, speed[::-1]), torque(model, 1, speed)])
        axes.plot(velocity, drawn, style, color=colour, label=NAMES[name])
        breakaway = [s * level for s in (-1, 1) if (level := _static(model, s)) is not None]
        if breakaway:
            axes.plot([0.0] * len(breakaway), breakaway, "D", color=colour, label="breakaway")
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.grid(alpha=0.3)
    quantities = comparison.quantities if comparison else Quantities()
    axes.set_xlabel(with_unit("velocity", quantities.velocity_unit))
    axes.set_ylabel(with_unit(quantities.effort, quantities.input_unit))
    axes.set_title("Dry and viscous friction")
    axes.legend(fontsize="small", loc="upper left")


def torque(model: Identification, sign: int, speed: Floats) -> Floats:
    """Force or torque at a constant velocity ``sign``·``speed``, in input units.

    It is the sum of dry friction, with a Stribeck curve if that is a cause; viscous friction
    a/K·(1 ± alpha)·v; and quadratic drag c·v·|v|.
    """
    level = _level(model, sign)
    excess = (_value(model, "stribeck.fs_over_fc") or 1.0) - 1.0
    decay = _value(model, "stribeck.stribeck_velocity") or 1.0
    dry = level * (1.0 + excess * np.exp(-((speed / decay) ** 2)))
    asymmetry = 1.0 + sign * (_value(model, "viscous_asymmetry.alpha") or 0.0)
    drag = (_value(model, "quadratic_drag.c") or 0.0) * speed**2
    return np.asarray(sign * (dry + _slope(model) * asymmetry * speed + drag))


def _slope(model: Identification) -> float:
    pole, constant = _value(model, "pole"), _value(model, "constant")
    if pole is None or not constant:
        raise ServoscopeError("the data do not determine the viscous friction")
    return -pole / constant


def _level(model: Identification, sign: int) -> float:
    for name in ("fc_plus" if sign > 0 else "fc_minus", "fc_mean"):
        if (value := _value(model, name)) is not None:
            return value
    raise ServoscopeError("the data do not determine the friction levels")


def _static(model: Identification, sign: int) -> float | None:
    return _value(model, f"static_friction.{'fs_plus' if sign > 0 else 'fs_minus'}")


def _guess(model: Identification) -> float:
    """A velocity at which viscous friction shows, where none was measured."""
    slope = _slope(model)
    return 2.0 * _level(model, 1) / slope if slope > 0 else 1.0


def _value(model: Identification, name: str) -> float | None:
    parameter = model.parameters.get(name)
    return parameter.value if parameter else None
