"""A study's results: its front, its choice, its table, and the files that it is kept in."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _arrays
from . import statistics
from .records import CaseRecord, Choice, NothingQualifies, Record, Summary, figure_text
from .statistics import Interval

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["SCHEMA", "Study"]

SCHEMA = 1
"""Version of the figures' layout in JSON."""

FEW = 8
"""As many settings are shown case by case; of more, each technique's most accurate."""


class CostUnit(NamedTuple):
    """How a study shows what its techniques cost."""

    per_ms: float
    """Costs as recorded (times in milliseconds) times this are in the unit."""
    short: str
    """A column's head: "ms"."""
    long: str
    """An axis' label: "milliseconds a frame"."""


@dataclass(frozen=True)
class Study:
    """What a study measured.

    Attributes
    ----------
    question, about : str
        What was asked.
    metric, mask : dict
        Name, unit and explanation of how errors were taken, and where.
    records, cases : tuple
        The figures of every setting in every case, and every case with its reference.
    machine, settings : dict
        What it ran on, and how it was run.
    techniques : dict of str to str
        What each technique says of itself.
    """

    question: str
    about: str
    metric: dict[str, str]
    mask: dict[str, str]
    records: tuple[Record, ...]
    cases: tuple[CaseRecord, ...]
    machine: dict[str, Any]
    settings: dict[str, Any]
    techniques: dict[str, str] = field(default_factory=dict)
    also: dict[str, str] = field(default_factory=dict)
    pictures: Callable[[tuple[str, str], Iterable[tuple[str, dict[str, Any]]]], Any] | None = field(
        default=None, repr=False, compare=False
    )

    def __repr__(self) -> str:
        settings = len({r.setting for r in self.records})
        return f"Study({self.question!r}, {settings} settings in {len(self.cases)} cases)"

    def __getstate__(self) -> dict[str, Any]:
        """All but the function that makes pictures: what it needs is not of the study."""
        return {**self.__dict__, "pictures": None}

    # What was measured, drawn together --------------------------------------------------------------------------

    def of(self, scene: str | None = None, view: str | None = None) -> Study:
        """The part of the study that belongs to one scene, or to one view of it.

        Raises
        ------
        ValueError
            If there is no such scene or view.
        """
        cases = tuple(c for c in self.cases if scene in (None, c.scene) and view in (None, c.view))
        if not cases:
            known = ", ".join(repr(c.name) for c in self.cases)
            raise ValueError(f"scene: expected one of {known}, got {scene!r}" + (f", view {view!r}" if view else ""))
        keys = {c.key for c in cases}
        return replace(self, cases=cases, records=tuple(r for r in self.records if r.case in keys))

    def summaries(self) -> list[Summary]:
        """Every setting over all its cases, the worst of each figure, cheapest first."""
        return sorted((s for s, _ in self._pooled()), key=lambda s: s.ms.value)

    def front(self, scene: str | None = None, view: str | None = None) -> list[Summary]:
        """The settings that no other beats beyond the confidence of both error and time, cheapest first.

        Parameters
        ----------
        scene, view : str, optional
            Look at one scene or view alone; otherwise each setting counts with its worst over all of them. Settings
            that were not measured in all of these cases (an `External` picture of one view) stand aside.

        Returns
        -------
        list of Summary

        Raises
        ------
        ValueError
            If there is no such scene or view.
        """
        part = self.of(scene, view) if scene is not None or view is not None else self
        pooled = [(s, r) for s, r in part._pooled() if s.complete]
        keep = statistics.nondominated([r for _, r in pooled], [s.ms for s, _ in pooled])
        return sorted(
            (s for (s, _), k in zip(pooled, keep, strict=True) if k), key=lambda s: (s.ms.value, s.error.value)
        )

    def pick(
        self,
        max_error: float | None = None,
        budget_ms: float | None = None,
        *,
        scene: str | None = None,
        view: str | None = None,
        techniques: Collection[str] | None = None,
    ) -> Choice:
        """The cheapest setting that keeps an error bound, or the most accurate within a budget.

        A setting keeps the bound if the upper end of the confidence interval of its worst error over scenes and views
        does; likewise with the budget. With both, the cheapest that keeps both.

        Parameters
        ----------
        max_error : float, optional
            The error allowed, in the question's metric.
        budget_ms : float, optional
            Milliseconds a frame, preparation included.
        scene, view : str, optional
            Look at one scene or view alone.
        techniques : collection of str, optional
            Choose among these alone; names that were not measured are passed over.

        Returns
        -------
        Choice
            Technique, knobs, error and milliseconds, with the metric and mask that they were judged by.

        Raises
        ------
        TypeError, ValueError
            If neither bound is given, or a bound is not a positive number; or a budget in milliseconds is asked of a
            study whose costs are others, such as bytes.
        NothingQualifies
            If no setting qualifies; the message names the one that comes nearest. It is a ValueError.
        """
        for name, bound in (("max_error", max_error), ("budget_ms", budget_ms)):
            if bound is not None and (isinstance(bound, bool) or not isinstance(bound, int | float | np.number)):
                raise TypeError(f"{name}: expected a positive number, got {bound!r}")
            if bound is not None and not (math.isfinite(bound) and bound > 0):
                raise ValueError(f"{name}: expected a positive number, got {bound}")
        if max_error is None and budget_ms is None:
            raise ValueError("max_error, budget_ms: expected one of them, or both")
        timed = self.settings.get("cost", "time") == "time"
        if budget_ms is not None and not timed:
            raise ValueError(f"budget_ms: expected a study of times, this one's costs are {self.cost_unit().long}")
        part = self.of(scene, view) if scene is not None or view is not None else self
        if techniques is not None and (isinstance(techniques, str) or not all(isinstance(t, str) for t in techniques)):
            raise TypeError(f"techniques: expected a collection of names, got {techniques!r}")
        able = [s for s in part.summaries() if s.complete and s.error.known and s.ms.known]
        if techniques is not None:
            able = [s for s in able if s.technique in techniques]
        wanted = []
        if max_error is not None:
            wanted.append(f"error at most {max_error:g}")
        if budget_ms is not None:
            wanted.append(f"at most {budget_ms:g} ms")
        asked = " and ".join(wanted)
        good = [
            s
            for s in able
            if (max_error is None or s.error.high <= max_error) and (budget_ms is None or s.ms.high <= budget_ms)
        ]
        if not good:
            near: Summary | None = None
            if able:
                within = [s for s in able if budget_ms is None or s.ms.high <= budget_ms]
                near = min(within, key=lambda s: s.error.high) if within else min(able, key=lambda s: s.ms.high)
            raise NothingQualifies(_nothing(asked, near, self.price()), near)
        by_error = max_error is None
        best = min(good, key=lambda s: (s.error.value, s.ms.value) if by_error else (s.ms.value, s.error.value))
        return Choice(
            best.technique,
            best.knobs,
            best.error.value,
            best.ms.value if timed else best.counters.get("ms", math.nan),
            self.metric["name"],
            self.mask["name"],
            best.error,
            best.ms,
            best.error_case,
            asked,
            best.cases,
            self.price(),
        )

    def _pooled(self) -> list[tuple[Summary, NDArray[np.float64]]]:
        """Each setting's summary, and bootstrap replicates of its worst error on draws common to all settings."""
        groups: dict[str, list[Record]] = {}
        for r in self.records:
            groups.setdefault(r.setting, []).append(r)
        counts = {c.key: np.array(c.tile_counts) for c in self.cases}
        draws = {k: statistics.resample(n, seed=i) for i, (k, n) in enumerate(counts.items())}
        totals = {k: draws[k] @ counts[k] for k in counts}
        pooled = []
        for group in groups.values():
            rows = []
            for r in group:
                if r.tiles and self.metric["aggregate"] != "max" and totals[r.case].all():
                    means = (draws[r.case] @ np.array(r.tiles)) / totals[r.case]
                    rows.append(statistics.root(means) if self.metric["aggregate"] == "rms" else means)
                else:
                    rows.append(np.full(statistics.REPLICATES, r.error.value))
            pooled.append((self._summary(group), np.max(rows, axis=0)))
        return pooled

    def _summary(self, group: list[Record]) -> Summary:
        names = {c.key: c.name for c in self.cases}
        # NaN, where an answer was not finite, is the worst of all.
        worst = max(group, key=lambda r: math.inf if math.isnan(r.error.value) else r.error.value)
        slowest = max(group, key=lambda r: r.ms.value)
        beside = {k: [v for r in group if math.isfinite(v := r.also.get(k, math.nan))] for k in worst.also}
        also = {k: max(values, default=math.nan) for k, values in beside.items()}
        counters = {k: max(r.counters.get(k, 0.0) for r in group) for r in group for k in r.counters}
        return Summary(
            worst.technique,
            worst.knobs,
            Interval(worst.error.value, worst.error.low, max(r.error.high for r in group)),
            min(r.error.value for r in group),
            max(r.frame_error for r in group),
            names[worst.case],
            Interval(slowest.ms.value, slowest.ms.low, max(r.ms.high for r in group)),
            slowest.spread,
            slowest.prepare_ms,
            names[slowest.case],
            len(group),
            len(group) == len(self.cases),
            _worst(r.bias for r in group),
            _worst(r.noise for r in group),
            _worst(r.precision for r in group),
            sum(r.strays for r in group),
            counters,
            also,
            worst.external,
        )

    @property
    def word(self) -> str:
        """What the judged figure is called: "error", or the name of a price."""
        return self.metric.get("word", "error")

    def price(self) -> tuple[str, float]:
        """The unit of a whole answer's cost, and what costs as recorded are multiplied by to be in it."""
        if self.settings.get("cost", "time") == "time":
            return "ms", 1.0
        unit = self.cost_unit()
        return unit.short, unit.per_ms

    def cost_unit(self) -> CostUnit:
        """How costs are shown: in milliseconds a frame, nanoseconds an element of what is no picture, or megabytes."""
        cost = self.settings.get("cost", "time")
        if cost != "time":
            return CostUnit(1e-6, "MB", "megabytes") if cost == "bytes" else CostUnit(1.0, cost, cost)
        element, counts = self.settings.get("element", "pixel"), {c.elements for c in self.cases}
        if element == "pixel" or len(counts) != 1 or 0 in counts:
            return CostUnit(1.0, "ms", "milliseconds a frame")
        return CostUnit(1e6 / counts.pop(), f"ns/{element}", f"nanoseconds a {element}")

    def best(self) -> list[tuple[str, dict[str, Any]]]:
        """Each technique's most accurate setting, in the order of the techniques."""
        order = list(dict.fromkeys(r.technique for r in self.records))
        found: dict[str, dict[str, Any]] = {}
        for s in sorted(self.summaries(), key=lambda s: s.error.value if s.error.known else math.inf):
            found.setdefault(s.technique, s.knobs)
        return [(t, found[t]) for t in order]

    def few(self) -> list[tuple[str, dict[str, Any]]]:
        """All settings where there are few, else each technique's most accurate one."""
        settings = {r.setting: (r.technique, r.knobs) for r in self.records}
        return list(settings.values()) if len(settings) <= FEW else self.best()

    # What one looks at ------------------------------------------------------------------------------------------

    def table(self, scene: str | None = None, view: str | None = None) -> str:
        """The settings as text, cheapest first; those on the front bear a star."""
        from .tables import text_table

        return text_table(self.of(scene, view) if scene is not None or view is not None else self)

    def by_case(self) -> str:
        """Error, figures beside and time, case by case, as text: of all settings, or the best of each technique."""
        from .tables import case_text

        return case_text(self)

    def __str__(self) -> str:
        return self.table()

    def _repr_html_(self) -> str:
        from .tables import html_table

        return html_table(self)

    def plot(self, scene: str | None = None, view: str | None = None) -> Figure:
        """Error against time, the front drawn through: a matplotlib Figure that shows itself in Jupyter.

        Raises
        ------
        ImportError
            Without matplotlib: `pip install 'shadelab[study]'`.
        """
        from .chart import figure

        return figure(self.of(scene, view) if scene is not None or view is not None else self)

    def report(self, directory: str | Path, *, max_error: float | None = None, budget_ms: float | None = None) -> Path:
        """Write index.html, which opens offline, and beside it the pictures (PNG, EXR) and figures (CSV, JSON).

        Returns the page's path. With `max_error` or `budget_ms` the page names the choice.
        """
        from .report import write

        return write(self, _arrays.path("directory", directory), max_error=max_error, budget_ms=budget_ms)

    # Files ------------------------------------------------------------------------------------------------------

    def as_dict(self) -> dict[str, Any]:
        """All figures as JSON has them; not finite numbers are None."""
        data = {
            "schema": SCHEMA,
            "question": self.question,
            "about": self.about,
            "metric": self.metric,
            "mask": self.mask,
            "machine": self.machine,
            "settings": self.settings,
            "techniques": self.techniques,
            "also": self.also,
            "cases": [c.as_dict() for c in self.cases],
            "records": [r.as_dict() for r in self.records],
        }
        plain: dict[str, Any] = _plain(data)
        return plain

    def to_json(self, path: str | Path) -> Path:
        """Write all figures as JSON; `load` reads them back."""
        path = Path(path)
        path.write_text(json.dumps(self.as_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
        return path

    save = to_json

    @classmethod
    def load(cls, path: str | Path) -> Study:
        """A study from the JSON that `save` wrote: its figures, without its pictures.

        Raises
        ------
        ValueError
            If the file is not a study, or of a newer schema.
        """
        try:
            data = json.loads(Path(path).read_text(encoding="utf-8"))
            schema = data["schema"]
        except (json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError):
            raise ValueError(f"{path}: not a study") from None
        if schema != SCHEMA:
            raise ValueError(f"{path}: expected schema {SCHEMA}, got {schema}")
        fields = {
            k: data[k] for k in ("question", "about", "metric", "mask", "machine", "settings", "techniques", "also")
        }
        return cls(
            **fields,
            records=tuple(Record.from_dict(_numbers(r)) for r in data["records"]),
            cases=tuple(CaseRecord.from_dict(c) for c in data["cases"]),
        )

    def to_csv(self, path: str | Path) -> Path:
        """Write one line for each setting in each case, and whether it is on the front of its own scene."""
        fronts = {scene: {s.setting for s in self.front(scene)} for scene in {c.scene for c in self.cases}}
        knobs = sorted({k for r in self.records for k in r.knobs})
        counters = sorted({k for r in self.records for k in r.counters})
        also = list(dict.fromkeys(k for r in self.records for k in r.also))
        plain = "frame_error bias noise precision strays".split()
        times = "spread prepare_ms run_ms rounds external".split()
        path = Path(path)
        with path.open("w", newline="", encoding="utf-8") as file:
            out = csv.writer(file)
            head = ["scene", "view", "technique", *knobs, "metric", "mask", "error", "error_low", "error_high", *plain]
            out.writerow([*head, *also, "ms", "ms_low", "ms_high", *times, *counters, "on_front"])
            for r in self.records:
                row: list[Any] = [r.scene, r.view, r.technique, *(r.knobs.get(k, "") for k in knobs)]
                row += [self.metric["name"], self.mask["name"], r.error.value, r.error.low, r.error.high]
                row += [getattr(r, k) for k in plain] + [r.also.get(k, "") for k in also]
                row += [r.ms.value, r.ms.low, r.ms.high] + [getattr(r, k) for k in times]
                row += [r.counters.get(k, "") for k in counters]
                out.writerow([*row, int(r.setting in fronts[r.scene])])
        return path


def _nothing(asked: str, near: Summary | None, unit: tuple[str, float]) -> str:
    if near is None:
        return f"nothing was measured in all cases, so nothing keeps {asked}"
    return (
        f"nothing keeps {asked} (confidence {statistics.CONFIDENCE:.0%}); the nearest is {near.setting}: error "
        f"{figure_text(near.error.value)} (up to {figure_text(near.error.high)}) in "
        f"{figure_text(near.ms.value * unit[1])} {unit[0]} (up to {figure_text(near.ms.high * unit[1])})"
    )


def _worst(values: Iterable[float | None]) -> float | None:
    known = [v for v in values if v is not None]
    return max(known) if known else None


def _plain(data: Any) -> Any:
    """Data as JSON has it: NumPy's numbers as Python's, tuples as lists, not finite numbers as None."""
    if isinstance(data, Mapping):
        return {str(k): _plain(v) for k, v in data.items()}
    if isinstance(data, list | tuple | np.ndarray):
        return [_plain(v) for v in data]
    if isinstance(data, bool | np.bool_):
        return bool(data)
    if isinstance(data, int | np.integer):
        return int(data)
    if isinstance(data, float | np.floating):
        return float(data) if math.isfinite(data) else None
    return data if data is None else str(data)


def _numbers(record: dict[str, Any]) -> dict[str, Any]:
    """A record's figures that JSON had as None, where None has no meaning, as NaN."""
    for name in ("frame_error", "spread", "prepare_ms", "run_ms"):
        if record[name] is None:
            record[name] = math.nan
    record["also"] = {k: math.nan if v is None else v for k, v in record["also"].items()}
    return record
