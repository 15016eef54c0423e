"""`run`: measure every candidate of a question over its knobs' range, on each scene and view."""

from __future__ import annotations

import gc
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _arrays
from .._runtime import set_threads
from .._runtime import threads as threads_now
from . import references, statistics
from .judge import Judge, Pictures, Setting, external_record, precision, repeat_seed, with_times
from .machine import machine
from .question import Candidate, Case, External, MonteCarlo, Question, _no_counters
from .records import CaseRecord, Record
from .results import Study
from .statistics import Interval

__all__ = ["run"]

Array = NDArray[Any]


@dataclass
class _Plan:
    """How a study is run."""

    question: Question
    settings: list[tuple[Candidate, dict[str, Any]]]
    external: list[External]
    seed: int
    rounds: int
    patience: float
    fraction: float
    reference_seconds: float
    causes: bool
    cache: bool


def run(
    question: str | Question,
    scene: Any = None,
    *,
    size: tuple[int, int] | None = None,
    candidates: Iterable[Candidate | External | Callable[[Any], Any]] = (),
    techniques: Iterable[str] | None = None,
    views: Mapping[str, Any] | None = None,
    seed: int = 0,
    threads: int | None = None,
    rounds: int = 9,
    patience: float = 0.4,
    fraction: float = 0.25,
    reference_seconds: float = 6.0,
    causes: bool = True,
    cache: bool = True,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Study:
    """Measure what each candidate of a question costs and what it loses.

    Parameters
    ----------
    question : str or Question
        A question of shadelab by its name ("soft shadows"), or one's own.
    scene : optional
        The scene to ask it on: a scene, the name of one of the question's, or a mapping of names to scenes. All of the
        question's own scenes otherwise.
    size : (int, int), optional
        Width and height of the picture; the question's own otherwise.
    candidates : iterable, optional
        More to measure beside the question's: a `Candidate`; a function `f(inputs)` that answers the question; an
        `External` picture with its time. Where the question's cost is a counter, only candidates that count it.
    techniques : iterable of str, optional
        The names of those of the question's candidates to measure; all otherwise.
    views : mapping, optional
        Views by name, in place of the question's.
    seed : int
        Of everything random; the same seed gives the same errors.
    threads : int, optional
        Threads to measure with; as many as are set otherwise.
    rounds : int
        Times that each setting is timed, in turn with all others after a first run that is not counted.
    patience : float
        Seconds after which a setting is timed no more in a case, once it was timed three times.
    fraction : float
        A Monte Carlo reference is refined until its own error is this fraction of the smallest error that it judges.
    reference_seconds : float
        Seconds that a case's reference may take; a reference that did not get there is marked so.
    causes : bool
        Also split errors by cause: noise by repeating with another seed, precision by running in double (settings that
        take longer than `patience` are not run in double).
    cache : bool
        Keep Monte Carlo references, by their content, in the user's cache (the directory SHADELAB_CACHE if set).
    progress : bool or callable, optional
        True for a bar, or a function of (done, total).

    Returns
    -------
    Study

    Raises
    ------
    TypeError, ValueError
        If the question, a scene, a technique or a parameter is not known or out of its domain, a candidate's answer has
        not the reference's shape, or a candidate lacks the counter that is the question's cost.

    Notes
    -----
    Errors are debiased: with the two independent halves A and B of a reference, the mean of (x − A)(x − B) over the
    mask estimates the squared error without the reference's noise. Intervals (95 %) come from a bootstrap over tiles of
    the picture; those of times from order statistics.

    Examples
    --------
    >>> import numpy as np
    >>> from shadelab.study import Candidate, Metric, Question, run
    >>> taylor = lambda x, _, terms: sum((-1) ** i * x ** (2 * i + 1) / math.factorial(2 * i + 1) for i in range(terms))
    >>> sine = Question(
    ...     "sine", {"[0, 1]": np.linspace(0.0, 1.0, 1001)}, np.sin, Metric("largest error", lambda x, r, _: x - r,
    ...     aggregate="max"), [Candidate("taylor", taylor, {"terms": (1, 2, 3)})], setup=lambda case: case.scene)
    >>> run(sine).pick(max_error=0.01).knobs
    {'terms': 2}
    """
    if isinstance(question, str):
        from .questions import find

        question = find(question)
    if not isinstance(question, Question):
        raise TypeError(f"question: expected a name or a Question, got {type(question).__name__}")
    candidates = list(candidates)
    plan = _Plan(
        question,
        _settings(question, candidates, techniques),
        [c for c in candidates if isinstance(c, External)],
        _arrays.count("seed", seed, 0, (1 << 64) - 1),
        _arrays.count("rounds", rounds, 1),
        _arrays.number("patience", patience, 0.0),
        _arrays.number("fraction", fraction, above=0.0),
        _arrays.number("reference_seconds", reference_seconds, 0.0),
        causes and question.causes,
        cache,
    )
    _check_prices(plan, candidates)
    if not plan.settings and not plan.external:
        raise ValueError("techniques: expected at least one, or candidates beside")
    size = _size(question.size if size is None else size)
    if threads is not None:
        threads = _arrays.count("threads", threads, 1, 4096)
    before = threads_now()
    try:
        if threads is not None:
            set_threads(threads)
        return _run(plan, list(_cases(question, scene, views, size, seed)), progress)
    finally:
        if threads is not None:
            set_threads(before)


def _check_prices(plan: _Plan, more: list[Any]) -> None:
    """Refuses what has no price before anything is measured."""
    cost = plan.question.cost
    if cost == "time":
        return
    for c in more:
        if isinstance(c, External):
            raise ValueError(f"candidates: {c.title!r} has a time, but what {plan.question.name!r} asks is {cost}")
    for candidate, _ in plan.settings:
        if candidate.counters is _no_counters:
            say = f"expected a Candidate whose counters give {cost!r}, the cost of {plan.question.name!r}"
            raise ValueError(f"candidates: {say}; {candidate.name!r} has none")


def _size(size: Any) -> tuple[int, int]:
    if isinstance(size, str) or not isinstance(size, Iterable):
        raise TypeError(f"size: expected (width, height), got {size!r}")
    sides = list(size)
    if len(sides) != 2:
        raise ValueError(f"size: expected (width, height), got {len(sides)} values")
    return _arrays.count("size", sides[0], 1), _arrays.count("size", sides[1], 1)


def _settings(
    question: Question, more: Iterable[Any], techniques: Iterable[str] | None
) -> list[tuple[Candidate, dict[str, Any]]]:
    """Every setting of every candidate, the user's among them."""
    chosen = list(question.candidates)
    if techniques is not None:
        if isinstance(techniques, str) or not isinstance(techniques, Iterable):
            raise TypeError(f"techniques: expected a list of names, got {techniques!r}")
        wanted, known = list(techniques), [c.name for c in chosen]
        for name in wanted:
            if name not in known:
                raise ValueError(f"techniques: expected some of {', '.join(map(repr, known))}, got {name!r}")
        chosen = [c for c in chosen if c.name in wanted]
    for c in more:
        if isinstance(c, Candidate):
            chosen.append(c)
        elif not isinstance(c, External):
            if not callable(c):
                raise TypeError(f"candidates: expected a Candidate, an External or a callable, got {type(c).__name__}")
            chosen.append(Candidate(getattr(c, "__name__", type(c).__name__), lambda inputs, _, f=c: f(inputs)))
    return [(c, knobs) for c in chosen for knobs in c.settings()]


def _cases(
    question: Question, scene: Any, views: Mapping[str, Any] | None, size: tuple[int, int], seed: int
) -> Iterable[Case]:
    """The cases that are asked about, in float32."""
    if scene is None:
        scenes = dict(question.scenes)
    elif isinstance(scene, str):
        if scene not in question.scenes:
            raise ValueError(f"scene: expected one of {', '.join(map(repr, question.scenes))}, got {scene!r}")
        scenes = {scene: question.scenes[scene]}
    else:
        scenes = dict(scene) if isinstance(scene, Mapping) else {"your scene": scene}
    if not scenes:
        raise ValueError("scene: expected at least one")
    if views is not None:
        if isinstance(views, Iterable) and not list(views):
            raise ValueError("views: expected at least one")
        if not isinstance(views, Mapping):
            raise TypeError(f"views: expected a mapping of names to views, got {type(views).__name__}")
    for name, source in scenes.items():
        made = source() if callable(source) else source
        for view_name, view in (views if views is not None else question.views(name, made)).items():
            yield Case(name, view_name, made, view, size, np.dtype(np.float32), seed)


class _Steps:
    """Progress in steps of nearly equal weight."""

    def __init__(self, progress: Any, label: str, total: int) -> None:
        self.tell = _arrays.progress_callback(progress, label)
        self.done, self.total = 0, total

    def step(self, n: int = 1) -> None:
        self.done = min(self.done + n, self.total)
        if self.tell:
            self.tell(self.done, self.total)


def _run(plan: _Plan, cases: list[Case], progress: Any) -> Study:
    question = plan.question
    steps = _Steps(progress, question.name, len(cases) * (2 * len(plan.settings) + 2))
    records: list[Record] = []
    described: list[CaseRecord] = []
    pictures = Pictures(question, plan.settings, plan.external)
    for i, case in enumerate(cases):
        new, about = _measure(plan, case, i == 0, steps, pictures)
        records += new
        described.append(about)
    known = {c.name: c for c, _ in plan.settings}
    return Study(
        question.name,
        question.about,
        {
            "name": question.metric.name,
            "unit": question.metric.unit,
            "about": question.metric.about,
            "aggregate": question.metric.aggregate,
            "low": question.metric.signs[0],
            "high": question.metric.signs[1],
            "word": question.metric.word,
        },
        {"name": question.mask.name, "about": question.mask.about},
        tuple(records),
        tuple(described),
        machine(),
        {
            "size": list(cases[0].size) if cases else [],
            "seed": plan.seed,
            "rounds": plan.rounds,
            "patience": plan.patience,
            "fraction": plan.fraction,
            "reference_seconds": plan.reference_seconds,
            "confidence": statistics.CONFIDENCE,
            "element": question.element,
            "cost": question.cost,
        },
        {name: c.about for name, c in known.items()} | {e.title: "A picture from elsewhere." for e in plan.external},
        {name: (f.__doc__ or "").strip() for name, f in question.also.items()},
        pictures,
    )


def _measure(
    plan: _Plan, case: Case, is_first: bool, steps: _Steps, pictures: Pictures
) -> tuple[list[Record], CaseRecord]:
    """One case: answers of all settings, the reference refined to judge them, then times in turn."""
    question = plan.question
    inputs = question.setup(case)
    name = references.key(question, case) if plan.cache else None
    halves = (references.load(name) if name else None) or references.first(question, inputs, case.seed)
    judge = Judge(question, inputs, halves)
    if not judge.mask.any():
        raise ValueError(f"scene: nothing to measure in {case.name!r}: {question.mask.nothing}")
    steps.step()

    # Answer once with every setting; this warms up what the timing then finds warm.
    settings, left_out = [], []
    for candidate, knobs in plan.settings:
        reason = candidate.domain(inputs)
        if reason is None:
            settings.append(Setting(candidate, dict(knobs)))
        elif (line := f"{candidate.name}: {reason}") not in left_out:
            left_out.append(line)
    doubles = question.setup(_in_double(case)) if plan.causes else None
    for s in settings:
        for repeat in range(2 if s.candidate.seeded and plan.causes else 1):
            answer, *seconds = s.answer(inputs, repeat_seed(case.seed, repeat))
            judge.value(s, answer)
            s.answers.append(np.asarray(answer))
            s.seconds = sum(seconds)
        if doubles is not None and s.seconds < plan.patience:
            s.precision = precision(judge, s, doubles, case.seed)
        steps.step()

    # Refine the reference until it can judge the best of them.
    found = [judge.error(s, question) for s in settings]
    target = plan.fraction * min((e for e in found if math.isfinite(e) and e > 0), default=math.inf)
    reached, before = True, halves.samples
    if isinstance(question.reference, MonteCarlo) and not halves.exact:
        cap = plan.reference_seconds
        reached = references.refine(
            halves, question.reference, inputs, case.seed, judge.mask, lambda h: judge.own_error(), target, cap
        )
        if name and (halves.samples > before or not halves.cached):
            references.store(name, halves)
    steps.step()

    records = [judge.record(s, case) for s in settings]
    pictures.keep(case, judge, settings)
    _time(plan, settings, inputs, case.seed, steps)
    records = [_priced(with_times(r, s, inputs), question) for r, s in zip(records, settings, strict=True)]
    records += [r for e in plan.external if (r := external_record(judge, e, case, is_first)) is not None]
    steps.step(len(plan.settings) - len(settings))
    plan_text, plan_html = _plan_of(question, case)
    about = CaseRecord(
        case.scene_name,
        case.view_name,
        case.size,
        float(np.mean(judge.mask)) if judge.mask.size else 0.0,
        judge.own_error(),
        halves.samples,
        halves.seconds,
        target if math.isfinite(target) else 0.0,
        reached,
        halves.cached,
        tuple(float(n) for n in judge.counts),
        plan_text,
        plan_html,
        tuple(left_out),
        judge.mask.size,
    )
    return records, about


def _priced(record: Record, question: Question) -> Record:
    """A record whose cost is a counter, where the question asks for that; the time becomes a counter."""
    if question.cost == "time":
        return record
    if question.cost not in record.counters:
        known = ", ".join(map(repr, record.counters)) or "none"
        raise ValueError(
            f"candidates: expected {question.cost!r} among the counters of {record.technique!r}, got {known}"
        )
    price = float(record.counters[question.cost])
    counters = {k: v for k, v in record.counters.items() if k != question.cost} | {"ms": record.ms.value}
    return replace(record, ms=Interval(price, price, price), spread=0.0, prepare_ms=0.0, counters=counters)


def _in_double(case: Case) -> Case:
    wide = np.dtype(np.float64)
    return Case(case.scene_name, case.view_name, case.scene, case.view, case.size, wide, case.seed)


def _plan_of(question: Question, case: Case) -> tuple[str, str]:
    """The renderer's plan of a case, as text and as HTML; empty where the question has none."""
    if question.plan is None:
        return "", ""
    plan = question.plan(case)
    html = getattr(plan, "_repr_html_", None)
    return str(plan), html() if html else ""


def _time(plan: _Plan, settings: Sequence[Setting], inputs: Any, seed: int, steps: _Steps) -> None:
    """Time all settings in turn, each round in another order, so that what drifts does not favour one."""
    order = np.random.default_rng(seed)
    left = list(settings)
    collecting = gc.isenabled()
    gc.disable()
    try:
        for r in range(plan.rounds):
            for i in order.permutation(len(left)):
                s = left[i]
                _, prepare, run_ = s.answer(inputs, repeat_seed(seed, r))
                s.prepare.append(prepare * 1e3)
                s.run.append(run_ * 1e3)
            done = [s for s in left if r + 1 == plan.rounds or (r >= 2 and _spent(s) > plan.patience * 1e3)]
            left = [s for s in left if not any(s is d for d in done)]
            steps.step(len(done))
    finally:
        if collecting:
            gc.enable()


def _spent(s: Setting) -> float:
    return sum(s.prepare) + sum(s.run)
