"""What a study ran on: without it no time means anything."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["build", "cpu_name", "machine", "version"]


def cpu_name() -> str:
    """The processor's name, as the system gives it."""
    with contextlib.suppress(OSError):
        if sys.platform.startswith("linux"):
            for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
                if line.lower().startswith("model name"):
                    return line.split(":", 1)[1].strip()
        if sys.platform == "darwin":
            command = ["/usr/sbin/sysctl", "-n", "machdep.cpu.brand_string"]
            return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    return platform.processor() or platform.machine()


def version() -> str:
    """The installed version of shadelab; "source" where it runs from its sources, uninstalled."""
    from importlib import metadata

    try:
        return metadata.version("shadelab")
    except metadata.PackageNotFoundError:
        return "source"


@functools.cache
def build() -> str:
    """A digest of the package, kernels and Python: two builds with one version number are still two builds."""
    from .. import _kernels

    state = hashlib.sha256(Path(_kernels.__file__).read_bytes())
    package = Path(__file__).resolve().parents[1]
    for path in sorted(package.rglob("*.py")):
        state.update(path.relative_to(package).as_posix().encode() + path.read_bytes())
    return state.hexdigest()[:16]


def machine() -> dict[str, Any]:
    """Processor, SIMD level, threads, system and versions."""
    from .._kernels import runtime

    return {
        "cpu": cpu_name(),
        "cores": os.cpu_count() or 1,
        "threads": runtime.threads(),
        "simd": runtime.simd_level(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "numpy": np.__version__,
        "shadelab": version(),
        "build": build(),
    }
