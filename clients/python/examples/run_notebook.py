"""Executes the example against a server and stores it with its outputs.

python run_notebook.py URL [OUTPUT]: without OUTPUT, in place.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).with_name("from_raw_samples.ipynb")


def main(url: str, output: str | None = None) -> None:
    """Execute the notebook; an error in a cell is an error here."""
    os.environ["SERVOSCOPE_URL"] = url
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=600, kernel_name="python3", record_timing=False).execute()
    # Which Python ran it says nothing about the example.
    notebook.metadata["language_info"] = {"name": "python"}
    nbformat.write(notebook, output or NOTEBOOK)


if __name__ == "__main__":
    main(*sys.argv[1:])
