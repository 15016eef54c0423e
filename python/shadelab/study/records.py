"""The figures of a study: what was measured of each setting in each case, and what each case was judged by."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from .statistics import Interval

__all__ = ["CaseRecord", "Choice", "NothingQualifies", "Record", "Summary", "figure_text", "setting_text"]


def figure_text(value: float | None) -> str:
    """A figure with three digits; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    if 1e3 <= abs(value) < 1e6:
        return f"{value:.0f}"
    return f"{value:.3g}" if 1e-4 <= abs(value) < 1e3 else f"{value:.1e}"


def setting_text(technique: str, knobs: Mapping[str, Any]) -> str:
    """A setting as one would call it: `pcf(samples=16, radius=0.1)`."""
    return f"{technique}({', '.join(f'{k}={_plain(v)}' for k, v in knobs.items())})" if knobs else technique


def _plain(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Record:
    """One setting in one case: its error over the mask by cause, its cost, its counters.

    `error` is the metric; `frame_error` the same over the whole frame. `bias` is what is left when the noise of random
    techniques is taken out, `noise` what repeating with another seed moves, `precision` what float32 differs from the
    same technique in float64; each is None where it cannot be told. `ms` is preparation and run together, the median of
    `rounds`; `spread` its median absolute deviation. `strays` counts values that are not finite. `tiles` are sums of
    squared error over tiles of the mask, from which intervals and comparisons are drawn.
    """

    technique: str
    knobs: dict[str, Any]
    scene: str
    view: str
    error: Interval
    frame_error: float
    ms: Interval
    spread: float
    prepare_ms: float
    run_ms: float
    rounds: int
    bias: float | None = None
    noise: float | None = None
    precision: float | None = None
    strays: int = 0
    counters: dict[str, float] = field(default_factory=dict)
    also: dict[str, float] = field(default_factory=dict)
    tiles: tuple[float, ...] = ()
    external: bool = False

    @property
    def setting(self) -> str:
        """Technique and knobs in one text."""
        return setting_text(self.technique, self.knobs)

    @property
    def case(self) -> tuple[str, str]:
        """Scene and view."""
        return (self.scene, self.view)

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and texts, as JSON has them."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Record:
        """The inverse of `as_dict`."""
        given = dict(data)
        given["error"], given["ms"] = _interval(given["error"]), _interval(given["ms"])
        given["tiles"] = tuple(given["tiles"])
        return cls(**given)


def _interval(data: Mapping[str, Any]) -> Interval:
    return Interval(*(np.nan if data[k] is None else data[k] for k in ("value", "low", "high")))


@dataclass(frozen=True)
class CaseRecord:
    """A case and its reference: how many samples it took, and the error that is left in it."""

    scene: str
    view: str
    size: tuple[int, int]
    mask_share: float
    reference_error: float
    reference_samples: int
    reference_seconds: float
    target: float
    reached: bool
    cached: bool
    tile_counts: tuple[float, ...] = ()
    plan: str = ""
    plan_html: str = ""
    left_out: tuple[str, ...] = ()
    elements: int = 0

    @property
    def name(self) -> str:
        """Scene and view in one line."""
        return f"{self.scene}, {self.view}" if self.view else self.scene

    @property
    def key(self) -> tuple[str, str]:
        """Scene and view."""
        return (self.scene, self.view)

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and texts, as JSON has them."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> CaseRecord:
        """The inverse of `as_dict`."""
        given = dict(data)
        for name in ("size", "tile_counts", "left_out"):
            given[name] = tuple(given[name])
        return cls(**given)


@dataclass(frozen=True, repr=False)
class Summary:
    """One setting over all the cases that it was measured in: the worst of each figure, and where.

    `error` and `ms` are the worst over scenes and views; `best_error` is the least, `frame_error` the worst over a
    whole frame; `error_case` and `ms_case` say where the worst was met. `cases` is how many it was measured in, and
    `complete` whether that is all.
    """

    technique: str
    knobs: dict[str, Any]
    error: Interval
    best_error: float
    frame_error: float
    error_case: str
    ms: Interval
    spread: float
    prepare_ms: float
    ms_case: str
    cases: int
    complete: bool
    bias: float | None
    noise: float | None
    precision: float | None
    strays: int
    counters: dict[str, float]
    also: dict[str, float]
    external: bool

    @property
    def setting(self) -> str:
        """Technique and knobs in one text."""
        return setting_text(self.technique, self.knobs)

    def __repr__(self) -> str:
        e, t = self.error, self.ms
        error = f"{figure_text(e.value)} [{figure_text(e.low)}, {figure_text(e.high)}]"
        return f"<{self.setting}: error {error}, {figure_text(t.value)} ms>"


@dataclass(frozen=True, repr=False)
class Choice:
    """What `pick` chose: technique, knobs, its worst error and time, the metric and mask that this was judged by.

    `ms` are milliseconds whatever the study's costs are. `cost_interval` is what it costs as recorded: `ms_interval`
    itself, but in a study of bytes bytes; times `unit[1]` it is in `unit[0]`.
    """

    technique: str
    knobs: dict[str, Any]
    error: float
    ms: float
    metric: str
    mask: str
    error_interval: Interval
    cost_interval: Interval
    error_case: str
    asked: str
    cases: int
    unit: tuple[str, float] = ("ms", 1.0)

    @property
    def setting(self) -> str:
        """Technique and knobs in one text."""
        return setting_text(self.technique, self.knobs)

    @property
    def ms_interval(self) -> Interval:
        """The confidence of `ms`; where the study's cost is another, `ms` alone is known."""
        return self.cost_interval if self.unit == ("ms", 1.0) else Interval(self.ms, self.ms, self.ms)

    def __str__(self) -> str:
        e, t = self.error_interval, self.cost_interval
        where = f"worst of {self.cases} cases: {self.error_case}" if self.cases > 1 else f"case: {self.error_case}"
        low, value, high = (figure_text(v * self.unit[1]) for v in (t.low, t.value, t.high))
        price = f"{value} {self.unit[0]}"
        return (
            f"{self.setting}: error {figure_text(e.value)} [{figure_text(e.low)}, {figure_text(e.high)}], "
            f"{price} [{low}, {high}] "
            f"({where}; {self.asked}; metric: {self.metric}; mask: {self.mask})"
        )

    def __repr__(self) -> str:
        return f"<{self}>"


class NothingQualifies(ValueError):
    """No setting keeps the bound; `best` is the one that comes nearest."""

    def __init__(self, message: str, best: Summary | None) -> None:
        super().__init__(message)
        self.best = best
