"""The program as a process, and measurements that it simulates."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

_REPOSITORY = Path(__file__).resolve().parents[3]

#: The program under test: that of ``SERVOSCOPE``, or the one that ``cargo build`` leaves.
PROGRAM = str(_REPOSITORY / os.environ.get("SERVOSCOPE", "target/debug/servoscope"))

#: An axis that sticks harder than it slides, measured quickly.
STICKY = ["--fs-plus", "0.8", "--fs-minus", "0.6"]


def simulated(*flags: str) -> str:
    """Simulate a measurement with noise of 60 dB, and give it as a table."""
    design = ["--noise-db", "60", "--harmonics", "5", "--frequency-range", "1:100:9"]
    command = [PROGRAM, "simulate", *design, *flags]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Server:
    """A server with a folder of its own."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="servoscope-")
        self._process: subprocess.Popen[str] | None = None
        self.url = "http://127.0.0.1:0"

    def start(self) -> None:
        """Start it, the second time where it was before."""
        listen = self.url.removeprefix("http://")
        where = ["--listen", listen, "--data-dir", self._folder.name, "--lease-seconds", "2"]
        self._process = subprocess.Popen(
            [PROGRAM, "serve", *where], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self._process.stdout
        line = self._process.stdout.readline()
        assert line.startswith("listening on "), f"{PROGRAM} did not start: {line}"
        self.url = line.removeprefix("listening on ").strip()

    def kill(self) -> None:
        """End it as a power cut does."""
        if self._process:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def end(self) -> None:
        """End it and remove its folder."""
        self.kill()
        self._folder.cleanup()
