"""Judging answers against a case's reference: errors, their intervals and causes, and the pictures of it."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import color
from . import statistics
from .question import Candidate, Case, External, Question
from .records import Record, setting_text
from .references import Halves
from .statistics import Interval

__all__ = ["Judge", "Pictures", "Setting", "external_record", "precision", "repeat_seed", "with_times"]

Array = NDArray[Any]
UNKNOWN = Interval(math.nan, math.nan, math.nan)

KEPT = 1 << 29
"""Bytes of answers that a study keeps for its pictures."""


@dataclass
class Setting:
    """One candidate with one setting of its knobs, while a case is measured."""

    candidate: Candidate
    knobs: dict[str, Any]
    answers: list[Array] = field(default_factory=list)
    seconds: float = 0.0
    precision: float | None = None
    prepare: list[float] = field(default_factory=list)
    run: list[float] = field(default_factory=list)
    rounds: int = 0

    def answer(self, inputs: Any, seed: int) -> tuple[Any, float, float]:
        """The answer, and the seconds that its preparation and its run took."""
        seeded = {"seed": seed} if self.candidate.seeded else {}
        begun = time.perf_counter()
        prepared = self.candidate.prepare(inputs, **self.knobs)
        between = time.perf_counter()
        answer = self.candidate.run(inputs, prepared, **self.knobs, **seeded)
        return answer, between - begun, time.perf_counter() - between


def repeat_seed(seed: int, repeat: int) -> int:
    """The seed of a candidate's repetition."""
    return int(np.random.SeedSequence([seed, repeat]).generate_state(1)[0])


class Judge:
    """Errors against one case's reference over its mask."""

    def __init__(self, question: Question, inputs: Any, halves: Halves, mask: Array | None = None) -> None:
        self.question, self.inputs, self.halves = question, inputs, halves
        reference = halves.mean
        residual = question.metric.residual(reference, reference, inputs)
        shape = residual.shape
        select = question.mask.select
        if mask is None:
            mask = np.ones(shape[:2], bool) if select is None else np.asarray(select(reference, inputs), bool)
        self.mask = mask
        labels = statistics.tile_labels(self.mask.shape)
        self.tiles = int(labels.max()) + 1 if labels.size else 0
        self.labels = labels[self.mask]
        self.counts = np.bincount(self.labels, minlength=self.tiles).astype(np.float64)

    def _residuals(self, value: Array) -> tuple[Array, Array]:
        metric, halves = self.question.metric.residual, self.halves
        a = metric(value, halves.a, self.inputs)
        return a, (a if halves.exact else metric(value, halves.b, self.inputs))

    def value(self, s: Setting, answer: Any) -> Array:
        """A setting's answer as it is judged."""
        return self.composed(s, self.inputs, answer)

    def composed(self, s: Setting, inputs: Any, answer: Any) -> Array:
        """An answer to some inputs as it is judged; what is not of the reference's shape is refused."""
        name, shape = s.candidate.name, self.halves.a.shape
        if answer is None:
            raise TypeError(f"{name}: expected an answer of shape {shape}, got None")
        try:
            value = np.asarray(self.question.compose(inputs, answer))
        except (TypeError, ValueError) as error:
            kind = TypeError if isinstance(error, TypeError) else ValueError
            raise kind(f"{name}: {error}") from error
        if value.shape != shape:
            raise ValueError(f"{name}: expected an answer of shape {shape}, got {value.shape}")
        if value.dtype.kind not in "fiub":
            raise TypeError(f"{name}: expected real numbers, got dtype {value.dtype}")
        return value

    def sums(self, value: Array) -> Array:
        """Per tile of the mask: sums of debiased squares, of magnitudes, or the largest magnitude."""
        a, b = (r[self.mask] for r in self._residuals(value))
        how = self.question.metric.aggregate
        if how == "rms":
            return statistics.product_sums(a, b, self.labels, self.tiles)[0]
        if how == "mean":
            return statistics.product_sums(np.abs(a), np.ones_like(a), self.labels, self.tiles)[0]
        largest = np.zeros(self.tiles)
        np.maximum.at(largest, self.labels, np.abs(a).reshape(len(a), -1).max(-1, initial=0.0))
        return largest

    def total(self, sums: Array) -> float:
        """The metric over the mask, of sums by tile."""
        if not self.counts.sum():
            return 0.0
        how = self.question.metric.aggregate
        if how == "max":
            return float(sums.max())
        mean = float(sums.sum() / self.counts.sum())
        return float(statistics.root(mean)) if how == "rms" else mean

    def interval(self, sums: Array) -> Interval:
        """The metric with its confidence."""
        value = self.total(sums)
        how = self.question.metric.aggregate
        if how == "max" or not self.counts.sum():
            return Interval(value, value, value)
        replicates = statistics.bootstrap(sums, self.counts)
        return statistics.interval_of(statistics.root(replicates) if how == "rms" else replicates, value)

    def own_error(self) -> float:
        """The reference's own error over the mask: half the root mean square difference of its halves."""
        if self.halves.exact:
            return 0.0
        apart = self.question.metric.residual(self.halves.a, self.halves.b, self.inputs)[self.mask]
        return float(np.sqrt(np.mean(np.square(apart, dtype=np.float64)))) / 2 if apart.size else 0.0

    def error(self, s: Setting, question: Question) -> float:
        """A setting's error as the reference sees it now."""
        return self.total(self.sums(self.value(s, s.answers[0])))

    def frame_error(self, value: Array) -> float:
        """The metric over the whole frame."""
        a, b = self._residuals(value)
        how = self.question.metric.aggregate
        if how == "rms":
            return float(statistics.root(np.mean(np.multiply(a, b, dtype=np.float64))))
        return float(np.max(np.abs(a), initial=0.0)) if how == "max" else float(np.mean(np.abs(a), dtype=np.float64))

    def shown(self, value: Array) -> dict[str, float]:
        """The figures beside."""
        reference = self.halves.mean
        return {n: float(np.mean(f(value, reference, self.inputs))) for n, f in self.question.also.items()}

    def record(self, s: Setting, case: Case) -> Record:
        """Everything about a setting but its times."""
        values = [self.value(s, a) for a in s.answers]
        strays = sum(int(np.count_nonzero(~np.isfinite(v))) for v in values)
        tiles = np.mean([self.sums(v) for v in values], axis=0)
        bias, noise = self._by_cause(s, values)
        return Record(
            s.candidate.name,
            s.knobs,
            case.scene_name,
            case.view_name,
            self.interval(tiles) if not strays else UNKNOWN,
            self.frame_error(values[0]),
            UNKNOWN,
            math.nan,
            math.nan,
            math.nan,
            0,
            bias,
            noise,
            s.precision,
            strays,
            {},
            self.shown(values[0]) if not strays else {},
            # Six digits suffice an interval, and keep the file of figures small.
            tuple(float(f"{t:.6g}") for t in tiles) if not strays else (),
        )

    def _by_cause(self, s: Setting, values: list[Array]) -> tuple[float | None, float | None]:
        """Bias and noise: two repetitions share the one and are independent in the other."""
        if self.question.metric.aggregate != "rms" or (s.candidate.seeded and len(values) < 2):
            return None, None
        (a0, b0), (a1, b1) = self._residuals(values[0]), self._residuals(values[-1])
        a0, b0, a1, b1 = (r[self.mask] for r in (a0, b0, a1, b1))
        if not a0.size:
            return 0.0, 0.0
        across = (np.multiply(a0, b1, dtype=np.float64) + np.multiply(a1, b0, dtype=np.float64)).mean() / 2
        apart = np.square(a0 - a1, dtype=np.float64).mean() / 2
        return float(statistics.root(across)), float(np.sqrt(apart))


def precision(judge: Judge, s: Setting, doubles: Any, seed: int) -> float:
    """How far the answer is from that of the same technique, with the same seed, in double."""
    question = judge.question
    wide = judge.composed(s, doubles, s.answer(doubles, repeat_seed(seed, 0))[0])
    apart = question.metric.residual(judge.value(s, s.answers[0]), wide, judge.inputs)[judge.mask]
    if not apart.size:
        return 0.0
    how = question.metric.aggregate
    size = np.abs(apart, dtype=np.float64)
    return float(np.sqrt(np.mean(size**2)) if how == "rms" else size.max() if how == "max" else size.mean())


def with_times(record: Record, s: Setting, inputs: Any) -> Record:
    """The record with the setting's times and counters."""
    both = np.add(s.prepare, s.run)
    interval = statistics.median_interval(both)
    counters = {k: float(v) for k, v in s.candidate.counters(inputs, **s.knobs).items()}
    return replace(
        record,
        ms=interval,
        spread=float(np.median(np.abs(both - interval.value))),
        prepare_ms=float(np.median(s.prepare)),
        run_ms=float(np.median(s.run)),
        rounds=len(both),
        counters=counters,
    )


def external_record(judge: Judge, external: External, case: Case, is_first: bool) -> Record | None:
    """A picture from elsewhere, judged as the others are."""
    picture = external.picture(case, is_first)
    if picture is None:
        return None
    return _judged(judge, external, case, np.asarray(picture))


def _judged(judge: Judge, external: External, case: Case, picture: Array) -> Record:
    shape = judge.halves.a.shape
    if picture.ndim == 3 and len(shape) == 3 and picture.shape[2] > shape[2]:
        picture = picture[..., : shape[2]]
    elif picture.ndim == 3 and len(shape) == 2 and picture.shape[2] in (3, 4):
        # Where answers are one number a pixel, of colours their luminance.
        picture = color.luminance(picture[..., :3])
    if picture.shape != shape:
        raise ValueError(f"{external.title}: expected a picture of shape {shape}, got {picture.shape}")
    strays = int(np.count_nonzero(~np.isfinite(picture)))
    sums = judge.sums(picture)
    ms = float(external.ms)
    return Record(
        external.title,
        {},
        case.scene_name,
        case.view_name,
        judge.interval(sums) if not strays else UNKNOWN,
        judge.frame_error(picture),
        Interval(ms, ms, ms),
        0.0,
        0.0,
        ms,
        0,
        strays=strays,
        also=judge.shown(picture) if not strays else {},
        tiles=tuple(float(f"{t:.6g}") for t in sums) if not strays else (),
        external=True,
    )


class Pictures:
    """The answers of a study for whoever wants to see them: kept while they are small, else made again.

    They are a function of the seed, so what is made again is what was measured.
    """

    def __init__(
        self, question: Question, settings: list[tuple[Candidate, dict[str, Any]]], external: list[External]
    ) -> None:
        self.question, self.settings, self.external = question, settings, external
        self.cases: dict[tuple[str, str], tuple[Case, Halves, Array]] = {}
        self.answers: dict[tuple[tuple[str, str], str], Array] = {}
        self.room = KEPT

    def keep(self, case: Case, judge: Judge, settings: Sequence[Setting]) -> None:
        """Take a case and its answers, which the settings then forget."""
        key = (case.scene_name, case.view_name)
        self.cases[key] = (case, judge.halves, judge.mask)
        for s in settings:
            first = s.answers[0]
            if first.nbytes <= self.room:
                self.room -= first.nbytes
                self.answers[(key, setting_text(s.candidate.name, s.knobs))] = first
            s.answers.clear()

    def __call__(self, key: tuple[str, str], wanted: Iterable[tuple[str, dict[str, Any]]]) -> dict[str, Any]:
        """Reference, mask, residual maps and 8-bit pictures of the wanted settings in one case."""
        case, halves, mask = self.cases[key]
        question = self.question
        inputs = question.setup(case)
        judge = Judge(question, inputs, halves, mask)
        made = {}
        for technique, knobs in wanted:
            value = self._value(judge, key, technique, knobs)
            if value is not None:
                made[(technique, tuple(knobs.items()))] = value
        reference = halves.mean
        return {
            "reference": reference,
            "mask": mask,
            "values": made,
            "residual": lambda v: question.metric.residual(v, reference, inputs),
            "display": None if question.display is None else lambda v: question.display(inputs, v),
            "also": {n: (lambda v, f=f: f(v, reference, inputs)) for n, f in question.also.items()},
        }

    def _value(self, judge: Judge, key: tuple[str, str], technique: str, knobs: dict[str, Any]) -> Array | None:
        case = self.cases[key][0]
        for candidate, own in self.settings:
            if candidate.name == technique and own == knobs:
                if candidate.domain(judge.inputs) is not None:
                    return None
                s = Setting(candidate, dict(knobs))
                answer = self.answers.get((key, setting_text(technique, knobs)))
                if answer is None:
                    answer = s.answer(judge.inputs, repeat_seed(case.seed, 0))[0]
                return judge.value(s, answer)
        for external in self.external:
            if external.title == technique:
                picture = external.picture(case, case is next(iter(self.cases.values()))[0])
                return None if picture is None else picture[..., :3]
        return None
