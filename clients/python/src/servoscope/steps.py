"""Requests as steps, so that the synchronous and the asynchronous client share their logic.

A function of the interface is a generator. It yields requests and pauses, is sent the
outcome of each, and returns its value. A client only carries the steps out.
"""

from __future__ import annotations

import os
import time
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias, TypeVar

import httpx

from .errors import ProblemError, ServerUnreachable, raise_for_problem

T = TypeVar("T")

DEFAULT_URL = "http://127.0.0.1:8080"

#: Answers after which the same request may succeed a little later.
_TRY_AGAIN = {429, 502, 503, 504}
#: Failures that repeating the request does not mend.
_HOPELESS = (httpx.UnsupportedProtocol, httpx.LocalProtocolError)
_LONGEST_PAUSE_S = 5.0


@dataclass(frozen=True)
class Request:
    """A request to the server.

    It must be safe to repeat: one that makes something carries an idempotency key.
    """

    method: str
    path: str
    params: Mapping[str, str] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    json: Any = None
    files: list[tuple[str, tuple[str | None, bytes]]] | None = None
    #: Seconds that the server may take to begin its answer; None: as the client is set.
    patience_s: float | None = None

    def arguments(self, client: httpx.Client | httpx.AsyncClient) -> dict[str, Any]:
        """Give the arguments of httpx's ``request``."""
        arguments: dict[str, Any] = {"method": self.method, "url": self.path}
        for name in ("params", "headers", "json", "files"):
            if value := getattr(self, name):
                arguments[name] = value
        if self.patience_s is not None:
            usual = client.timeout
            read = None if usual.read is None else usual.read + self.patience_s
            arguments["timeout"] = httpx.Timeout(
                connect=usual.connect, read=read, write=usual.write, pool=usual.pool
            )
        return arguments


@dataclass(frozen=True)
class Pause:
    """Time to let pass, seconds."""

    seconds: float


Step: TypeAlias = Request | Pause
Outcome: TypeAlias = httpx.Response | httpx.TransportError | None
Steps: TypeAlias = Generator[Step, Outcome, T]


def send(request: Request, give_up_after_s: float) -> Steps[httpx.Response]:
    """Send a request until the server answers it, for at most so many seconds.

    Raises:
        ProblemError: The server refused the request.
        ServerUnreachable: No answer within that time.
    """
    deadline = time.monotonic() + give_up_after_s
    pause_s = 0.1
    while True:
        outcome = yield request
        hopeless = isinstance(outcome, _HOPELESS)
        late = hopeless or time.monotonic() + pause_s > deadline
        if isinstance(outcome, httpx.Response):
            if outcome.status_code not in _TRY_AGAIN or late:
                raise_for_problem(outcome)
                return outcome
        elif late:
            raise ServerUnreachable(f"the server does not answer: {outcome}") from outcome
        yield Pause(pause_s)
        pause_s = min(2 * pause_s, _LONGEST_PAUSE_S)


def send_if_there(request: Request, give_up_after_s: float) -> Steps[httpx.Response | None]:
    """Send a request; None where the server has nothing of this name (404)."""
    try:
        return (yield from send(request, give_up_after_s))
    except ProblemError as problem:
        if problem.status == 404:
            return None
        raise


def http_settings(base_url: str, api_key: str | None, timeout_s: float) -> dict[str, Any]:
    """Give the settings of an httpx client; without a key, with that of ``SERVOSCOPE_KEY``.

    Raises:
        ValueError: The key cannot be sent. The message does not show it.
    """
    key = os.environ.get("SERVOSCOPE_KEY") if api_key is None else api_key
    if key and not (key.isascii() and key.isprintable()):
        raise ValueError("api_key is not visible ASCII text on one line")
    headers = {"Authorization": f"Bearer {key}"} if key else {}
    return {"base_url": base_url, "headers": headers, "timeout": httpx.Timeout(timeout_s)}
