"""Requests that both clients make, as steps."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, TypeAlias
from urllib.parse import quote
from uuid import uuid4

from .jobs import Kind
from .measurements import Measurement
from .steps import Request, Steps, send
from .uploads import Source, UploadSettings, form

Order: TypeAlias = Literal[0, 1, 2]
Priority: TypeAlias = Literal["low", "normal", "high"]


def upload(
    source: Source, settings: UploadSettings, key: str | None, give_up_after_s: float
) -> Steps[Measurement]:
    """Upload a measurement. Sent again, the request gives the same measurement."""
    headers = {"Idempotency-Key": key or str(uuid4())}
    files = form(source, settings)
    request = Request("POST", "/v1/measurements", headers=headers, files=files, patience_s=120)
    return Measurement.of((yield from send(request, give_up_after_s)).json())


def measurement(measurement_id: str, give_up_after_s: float) -> Steps[Measurement]:
    """Ask for a measurement."""
    request = Request("GET", f"/v1/measurements/{quote(measurement_id, safe='')}")
    return Measurement.of((yield from send(request, give_up_after_s)).json())


def job_body(
    kind: str,
    measurement: Measurement | str,
    actuator_order: Order | None,
    method: str | None,
    options: dict[str, Any] | None,
    priority: Priority | None,
    validation: Measurement | str | None = None,
) -> dict[str, Any]:
    """Say what a job asks for; what is None is left to the server."""
    plant = None if actuator_order is None else {"actuator_order": actuator_order}
    body = {
        "measurement_id": _id(measurement),
        "kind": kind,
        "plant": plant,
        "method": method,
        "options": options,
        "priority": priority,
        "validation_measurement_id": None if validation is None else _id(validation),
    }
    return {name: value for name, value in body.items() if value is not None}


def batch_body(
    measurements: Iterable[Measurement | str],
    kind: Kind,
    name: str | None,
    actuator_order: Order | None,
    method: str | None,
    options: dict[str, Any] | None,
    priority: Priority | None,
) -> dict[str, Any]:
    """Say what a batch asks for; what is None is left to the server."""
    plant = None if actuator_order is None else {"actuator_order": actuator_order}
    body = {
        "name": name,
        "kind": kind,
        "measurement_ids": [_id(one) for one in measurements],
        "plant": plant,
        "method": method,
        "options": options,
        "priority": priority,
    }
    return {name: value for name, value in body.items() if value is not None}


def _id(measurement: Measurement | str) -> str:
    return measurement if isinstance(measurement, str) else measurement.id
