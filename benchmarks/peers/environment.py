"""The peers' own environment, and what this machine is."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from datetime import date
from pathlib import Path
from typing import Any

import detumble
from detumble.errors import RequestError
from peers.process import FOLDER

UV = FOLDER.parents[1] / ".tools/bin/uv"
VENV = FOLDER / ".venv"
REQUIREMENTS = FOLDER / "requirements.txt"
NEWER = ("python3.12", "python3.13", "python3.14")
"""V-BAR needs one of these; the other peers run on detumble's Python too."""
MEASURED = ("bsk==", "jax==", "numba==", "numpy==", "scipy==", "vbar==")


def peers_python(asked: str | None) -> Path:
    """Give the interpreter of the peers' environment, made anew when its contents are not those pinned.

    Args:
        asked: the Python to make it with; None keeps the one it has, takes the first of `NEWER` that runs here, or else
            detumble's own.

    Raises:
        RequestError: it cannot be made.
    """
    stamp, python = VENV / "made-of", VENV / "bin" / "python"
    made_of = stamp.read_text() if stamp.exists() else ""
    base = asked or made_of.partition("\n")[0] or next((name for name in NEWER if _runs(name)), sys.executable)
    wanted = f"{base}\n{REQUIREMENTS.read_text()}"
    if made_of == wanted:
        return python
    if not UV.exists():
        raise RequestError(f"{UV} is missing; `make setup` puts it there")
    print(f"setting up the peers in {VENV} ...", file=sys.stderr)
    for command in (
        ["venv", "--quiet", "--clear", "--no-python-downloads", "--python", base, str(VENV)],
        ["pip", "install", "--quiet", "--python", str(python), "--requirements", str(REQUIREMENTS)],
    ):
        done = subprocess.run([UV, *command], stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode:
            raise RequestError(f"the peers cannot be set up: {done.stderr.strip()}")
    stamp.write_text(wanted)
    return python


def _runs(name: str) -> bool:
    """Tell whether a Python is there and starts: a shim of a version manager may only print an error."""
    found = shutil.which(name)
    return found is not None and subprocess.run([found, "-c", ""], capture_output=True, check=False).returncode == 0


def machine(python: Path) -> dict[str, Any]:
    """Say what the figures are measured on.

    Args:
        python: the peers'.
    """
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": names[0] if names else platform.processor() or platform.machine(),
        "cores": os.cpu_count() or 1,
        "load_before": round(os.getloadavg()[0], 2),
        "date": date.today().isoformat(),
        "python": platform.python_version(),
        "peers_python": subprocess.run([python, "-V"], capture_output=True, text=True, check=True).stdout.split()[-1],
        "detumble": detumble.__version__,
        "peers": [
            line.partition(" ;")[0] for line in REQUIREMENTS.read_text().splitlines() if line.startswith(MEASURED)
        ],
    }
