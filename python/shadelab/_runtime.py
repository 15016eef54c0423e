"""Threads and SIMD levels: how kernels run, never what they compute."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from . import _arrays
from ._kernels import runtime as _kernels

__all__ = ["set_threads", "simd", "simd_level", "simd_levels", "threads"]


def threads() -> int:
    """The number of threads that kernels spread their work over.

    Set by `set_threads`, else by the environment variable SHADELAB_THREADS, else one a core.

    Examples
    --------
    >>> threads() >= 1
    True
    """
    return _kernels.threads()


def set_threads(n: int | None) -> None:
    """Set the number of threads, at any time; None returns to one a core.

    Results never depend on it. Work under way keeps the threads it started with; a forked child starts its own.

    Parameters
    ----------
    n : int or None
        At least 1, at most 4096.

    Raises
    ------
    TypeError, ValueError
        If `n` is not an integer, or out of range.
    """
    _kernels.set_threads(0 if n is None else _arrays.count("n", n, 1, 4096))


def simd_level() -> str:
    """The SIMD level in force: the best that machine and build have, unless forced."""
    return _kernels.simd_level()


def simd_levels() -> tuple[str, ...]:
    """The SIMD levels of this machine that kernels were compiled for, least first.

    Examples
    --------
    >>> simd_levels()[0]
    'baseline'
    """
    return tuple(_kernels.simd_levels())


@contextmanager
def simd(level: str) -> Iterator[None]:
    """Force a SIMD level for the kernels called inside a `with` block (of every thread).

    Results are the same at each level beyond the rounding that a docstring states; this is how tests show it.

    Parameters
    ----------
    level : str
        One of `simd_levels()`.

    Raises
    ------
    TypeError, ValueError
        If this machine has no such level.

    Examples
    --------
    >>> with simd("baseline"):
    ...     simd_level()
    'baseline'
    """
    before = simd_level()
    _kernels.force_simd(_arrays.choice("level", level, simd_levels()))
    try:
        yield
    finally:
        _kernels.force_simd(before)


def _check_environment() -> None:
    """Refuse settings that would otherwise be passed over in silence."""
    level = os.environ.get("SHADELAB_SIMD")
    if level is not None and level not in simd_levels():
        raise ImportError(f"SHADELAB_SIMD: expected one of {', '.join(simd_levels())}, got {level!r}")
    n = os.environ.get("SHADELAB_THREADS")
    if n is not None and not (n.isdecimal() and 1 <= int(n) <= 4096):
        raise ImportError(f"SHADELAB_THREADS: expected an integer from 1 to 4096, got {n!r}")


_check_environment()
