"""The stability table: every kernel at the extremes of its domain, against an oracle.

A chapter's extremes stand in `study/extremes/<chapter>.py`, and in `<chapter>_<part>.py`. Each measures, in float32 and
in float64, the largest error seen against a higher precision (mpmath, exact rationals, or float64 for float32), and
counts NaN and infinity where none belongs. `claim` is what the docstring promises on that domain; `tests/extremes`
holds it.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Extreme", "Measurement", "Row", "extreme", "extremes", "measure", "table", "ulps"]


@dataclass(frozen=True)
class Measurement:
    """What one extreme showed: the largest error, strays (NaN and infinity where none belongs), cases tried."""

    error: float
    cases: int
    strays: int = 0


@dataclass(frozen=True)
class Extreme:
    """One kernel at one extreme; `claim` is the largest error allowed, per dtype name, in `unit`."""

    kernel: str
    name: str
    domain: str
    unit: str
    claim: Mapping[str, float]
    measure: Callable[[np.dtype], Measurement]

    @property
    def chapter(self) -> str:
        """The chapter that the kernel lives in."""
        return self.kernel.split(".")[0]


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    extreme: Extreme
    dtype: str
    result: Measurement

    @property
    def holds(self) -> bool:
        """Whether the claim was kept: error within it, and no strays."""
        return self.result.strays == 0 and self.result.error <= self.extreme.claim[self.dtype]


_REGISTRY: dict[str, list[Extreme]] = {}


def extreme(
    kernel: str, name: str, *, domain: str, unit: str, claim: float | Mapping[str, float]
) -> Callable[[Callable[[np.dtype], Measurement]], Callable[[np.dtype], Measurement]]:
    """Register a function `(dtype) -> Measurement` as an extreme of `kernel` ("chapter.function").

    `unit` is "ulp", "eps" (absolute, in rounding units of the precision), "relative", "absolute" or "count" (of wrong
    answers, where the claim is 0 as a rule).
    """
    claims = dict(claim) if isinstance(claim, Mapping) else {"float32": claim, "float64": claim}

    def register(measure: Callable[[np.dtype], Measurement]) -> Callable[[np.dtype], Measurement]:
        chapter = kernel.split(".")[0]
        _REGISTRY.setdefault(chapter, []).append(Extreme(kernel, name, domain, unit, claims, measure))
        return measure

    return register


def extremes(chapter: str | None = None) -> list[Extreme]:
    """All registered extremes, or one chapter's.

    Raises
    ------
    ValueError
        If no chapter of that name has extremes.
    """
    from . import extremes as package

    files = sorted(m.name for m in pkgutil.iter_modules(package.__path__))
    known = sorted({name.split("_")[0] for name in files})
    if chapter is not None and chapter not in known:
        raise ValueError(f"chapter: expected one of {', '.join(known)}, got {chapter!r}")
    names = known if chapter is None else [chapter]
    for file in files:
        if file.split("_")[0] in names:
            importlib.import_module(f"{package.__name__}.{file}")
    return [e for name in names for e in _REGISTRY.get(name, [])]


def measure(chosen: Iterable[Extreme]) -> list[Row]:
    """Run extremes in every precision that they claim something for."""
    return [Row(e, d, e.measure(np.dtype(d))) for e in chosen for d in e.claim]


def table(rows: Iterable[Row]) -> str:
    """The rows as text, one a line."""
    head = f"{'kernel':34} {'extreme':40} {'dtype':8} {'error':>10} {'claim':>10} {'unit':9} {'strays':>6} {'cases':>8}"
    lines = [head, "-" * len(head)]
    for r in rows:
        e = r.extreme
        lines.append(
            f"{e.kernel:34.34} {e.name:40.40} {r.dtype:8} {r.result.error:10.3g} {e.claim[r.dtype]:10.3g} "
            f"{e.unit:9} {r.result.strays:6d} {r.result.cases:8d}{'' if r.holds else '  FAILS'}"
        )
    return "\n".join(lines)


def ulps(value: ArrayLike, exact: ArrayLike, dtype: np.dtype | type) -> NDArray[np.float64]:
    """Errors in units of the last place of `exact` (given in a wider precision) in `dtype`."""
    wide = np.longdouble
    exact_wide = np.asarray(exact, wide)
    spacing = np.spacing(np.abs(exact_wide).astype(dtype)).astype(wide)
    return np.asarray(np.abs(np.asarray(value).astype(wide) - exact_wide) / spacing, np.float64)
