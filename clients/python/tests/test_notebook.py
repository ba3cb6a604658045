"""The example as a reader finds it, and as it runs."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

from server import Server

_EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
_STORED = _EXAMPLES / "from_raw_samples.ipynb"


def _outputs(path: Path) -> str:
    cells = json.loads(path.read_text())["cells"]
    return json.dumps([cell["outputs"] for cell in cells if cell["cell_type"] == "code"])


def test_the_notebook_runs_and_finds_what_is_hidden(server: Server, tmp_path: Path) -> None:
    output = tmp_path / "executed.ipynb"
    command = [sys.executable, str(_EXAMPLES / "run_notebook.py"), server.url, str(output)]
    subprocess.run(command, check=True, capture_output=True)
    assert "viscous_asymmetry, confidence above 99.9 %" in _outputs(output)


def test_the_stored_outputs_are_small_and_name_no_machine() -> None:
    outputs = _outputs(_STORED)
    assert _STORED.stat().st_size < 400_000
    assert "viscous_asymmetry, confidence above 99.9 %" in outputs
    assert "image/png" in outputs
    assert not re.search(r"/(home|root|tmp|usr|work)/|127\.0\.0\.1:\d{4}|\"stderr\"", outputs)
