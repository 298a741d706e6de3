"""The machine that figures were taken on: its name, and the versions of what ran."""

from __future__ import annotations

import os
import platform
import re
from pathlib import Path

import numpy as np

from .. import _core


def processor() -> str:
    """Return the model of the processor."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return found[1].strip() if found else platform.processor() or platform.machine()


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def slug() -> str:
    """Return the name of the machine's folder of results, such as ``amd-epyc-2-cores``."""
    words = re.sub(r"[^a-z0-9]+", "-", processor().lower()).strip("-") or "unknown"
    return f"{words}-{cores()}-cores"


def versions() -> dict[str, str]:
    """Return the versions of what runs."""
    return {
        "springform": _core.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
    }
