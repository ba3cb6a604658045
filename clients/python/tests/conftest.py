"""A live server for all tests, and a diagnosis that several of them look at."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import pytest
from server import STICKY, Server, simulated

from servoscope import Client, Diagnosis

mpl.use("agg")


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    server = Server()
    server.start()
    yield server
    server.end()


@pytest.fixture(scope="session")
def client(server: Server) -> Iterator[Client]:
    with Client(server.url) as client:
        yield client


@pytest.fixture(scope="session")
def sticky(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A measurement of an axis that sticks harder than it slides."""
    path = tmp_path_factory.mktemp("measured") / "sticky.csv"
    path.write_text(simulated(*STICKY))
    return path


@pytest.fixture(scope="session")
def diagnosis(client: Client, sticky: Path) -> Diagnosis:
    """Its diagnosis, with units that no page and no figure may take for markup."""
    measurement = client.upload(sticky, input="current $A<b>", response="velocity rad/s")
    return client.diagnose(measurement, actuator_order=0).wait(progress=False)
