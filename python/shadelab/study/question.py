"""What a study asks: a question, its reference, its metric and mask, and the candidates that answer it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Candidate", "Case", "External", "Mask", "Metric", "MonteCarlo", "Question"]

Array: TypeAlias = NDArray[Any]
Knobs: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """One scene seen in one view: what `Question.setup` turns into the inputs of candidates and reference."""

    scene_name: str
    view_name: str
    scene: Any
    view: Any
    size: tuple[int, int]
    dtype: np.dtype[Any]
    seed: int

    @property
    def name(self) -> str:
        """Scene and view in one line."""
        return f"{self.scene_name}, {self.view_name}" if self.view_name else self.scene_name


@dataclass(frozen=True)
class Metric:
    """How far an answer is from the reference.

    Parameters
    ----------
    name, unit, about : str
        Shown with every figure; `about` is a sentence for the glossary.
    residual : callable
        `residual(value, reference, inputs)` gives the signed error at each element. With a Monte Carlo reference it
        must be linear in the reference, since two halves of it enter one by one.
    aggregate : {"rms", "mean", "max"}
        Root of the mean square, mean magnitude, or largest magnitude over the mask.
    signs : (str, str)
        What a negative and a positive residual mean.
    word : str
        What tables and charts call the figure, where it is no error but a price.
    """

    name: str
    residual: Callable[[Array, Array, Any], Array]
    unit: str = ""
    about: str = ""
    aggregate: Literal["rms", "mean", "max"] = "rms"
    signs: tuple[str, str] = ("too dark", "too bright")
    word: str = "error"


@dataclass(frozen=True)
class Mask:
    """Where a technique matters: `select(reference, inputs)` gives a boolean for each element (None: everywhere).

    `nothing` says in a clause what is missing where it selects none.
    """

    name: str = "everywhere"
    select: Callable[[Array, Any], Array] | None = None
    about: str = ""
    nothing: str = "the mask selects no pixel"


@dataclass(frozen=True)
class MonteCarlo:
    """A reference with noise of its own, refined until it can judge.

    Parameters
    ----------
    estimate : callable
        `estimate(inputs, samples, seed, start, where)` gives the mean over samples `start … start + samples` of the
        stream `seed`, shaped like an answer. `where` is None or a mask of the elements wanted; the others may
        hold anything.
    first, most : int
        Samples of each half to begin with, and never exceeded.
    """

    estimate: Callable[[Any, int, int, int, Array | None], Array]
    first: int = 64
    most: int = 1 << 16


def _nothing(inputs: Any, **knobs: Any) -> Any:
    return None


def _no_counters(inputs: Any, **knobs: Any) -> Mapping[str, float]:
    return {}


def _anywhere(inputs: Any) -> str | None:
    return None


@dataclass(frozen=True)
class Candidate:
    """A technique with its knobs.

    Parameters
    ----------
    name : str
        The technique.
    run : callable
        `run(inputs, prepared, **knobs)` answers the question; it is timed. A `seeded` candidate gets `seed=` too.
    knobs : mapping of str to sequence, or sequence of mappings
        The range of each knob (all combinations are measured), or the settings themselves.
    prepare : callable, optional
        `prepare(inputs, **knobs)` does what each frame needs before `run` (a shadow map); timed apart, and part
        of the cost.
    counters : callable, optional
        `counters(inputs, **knobs)` gives what carries to other machines: {"taps": 16, "rays": 0, "bytes": …} a pixel.
    domain : callable, optional
        `domain(inputs)` says in a sentence why the technique does not apply to these inputs, or gives None.
    seeded : bool
        Whether the answer is random: it is then repeated with another seed, which tells noise from bias.
    about : str
        What it does and where it is known to fail, for the glossary.
    """

    name: str
    run: Callable[..., Any]
    knobs: Mapping[str, Sequence[Any]] | Sequence[Knobs] = field(default_factory=dict)
    prepare: Callable[..., Any] = _nothing
    counters: Callable[..., Mapping[str, float]] = _no_counters
    domain: Callable[[Any], str | None] = _anywhere
    seeded: bool = False
    about: str = ""

    def settings(self) -> list[dict[str, Any]]:
        """Every combination of knobs that is measured."""
        if isinstance(self.knobs, Mapping):
            names = list(self.knobs)
            return [dict(zip(names, v, strict=True)) for v in itertools.product(*self.knobs.values())]
        return [dict(k) for k in self.knobs]


@dataclass(frozen=True)
class External:
    """A picture from elsewhere (an engine, another renderer) and the time that it took there.

    Parameters
    ----------
    path : path, or mapping of str to path
        A picture (EXR, HDR, PNG) of the question's first view; or one for each view or scene, by its name
        ("view", "scene" or "scene, view"). Where answers are one number a pixel (lit fractions), of colours their
        luminance counts.
    ms : float
        Milliseconds a frame, as measured where the picture was made.
    name : str, optional
        How to call it; the file's stem otherwise.
    """

    path: str | Path | Mapping[str, str | Path]
    ms: float
    name: str = ""

    def __post_init__(self) -> None:
        paths = list(self.path.values()) if isinstance(self.path, Mapping) else [self.path]
        if not paths:
            raise ValueError("path: expected at least one picture")
        for path in paths:
            if not isinstance(path, str | Path):
                raise TypeError(f"path: expected a path, or paths by view or scene, got {type(path).__name__}")
        if isinstance(self.ms, bool) or not isinstance(self.ms, int | float | np.number):
            raise TypeError(f"ms: expected a number, got {type(self.ms).__name__}")
        if not np.isfinite(self.ms) or self.ms < 0:
            raise ValueError(f"ms: expected a finite number of milliseconds, at least 0, got {self.ms}")

    @property
    def title(self) -> str:
        """The name, or the file's stem."""
        if self.name:
            return self.name
        path = next(iter(self.path.values())) if isinstance(self.path, Mapping) else self.path
        return Path(path).stem

    def picture(self, case: Case, first: bool) -> Array | None:
        """The picture that belongs to a case; None if it has none. `first` marks the question's first case."""
        from .. import scene

        path: Any = self.path
        if isinstance(path, Mapping):
            path = next((path[k] for k in (case.name, case.view_name, case.scene_name) if k in path), None)
        elif not first:
            path = None
        return None if path is None else np.asarray(scene.load_image(path))


def _same(inputs: Any, answer: Any) -> Array:
    return np.asarray(answer)


def _case(case: Case) -> Any:
    return case


def _one_view(name: str, scene: Any) -> Mapping[str, Any]:
    return {"": None}


@dataclass(frozen=True)
class Question:
    """What is asked, on which scenes, judged how, and of whom.

    Parameters
    ----------
    name : str
        "soft shadows" and the like.
    scenes : mapping of str to scene or callable
        The scenes, or functions that make them when they are needed.
    reference : callable or MonteCarlo
        `reference(inputs)` gives the exact answer; or a `MonteCarlo` estimate of it.
    metric, mask : Metric, Mask
        How errors are taken, and over which elements.
    candidates : sequence of Candidate
        The techniques.
    views : callable
        `views(name, scene)` gives the views of a scene by name.
    setup : callable
        `setup(case)` makes the inputs that reference and candidates share (a G-buffer); not timed.
    compose : callable
        `compose(inputs, answer)` turns what a candidate returns into what is judged (a picture); not timed.
    also : mapping of str to callable
        Figures shown beside: `f(value, reference, inputs) -> float`, or a map of errors whose mean is the figure.
    display : callable, optional
        `display(inputs, value)` gives an 8-bit picture (H, W, 3) of a value, for reports.
    plan : callable, optional
        `plan(case)` gives the renderer's plan of a case, shown in reports.
    size : (int, int)
        Width and height that the question is asked at unless told otherwise.
    about : str
        One paragraph: what is asked and why.
    causes : bool
        Whether errors can be split by cause; False where what is judged is no answer but a price.
    max_error : float
        The bound that the command line asks for unless told otherwise.
    cost : str
        What stands against the error: "time", or the name of a counter such as "bytes"; the time is then one of the
        counters.
    element : str
        What an answer is made of. "pixel": it is a picture, and its time is that of a frame. Anything else ("ray"):
        times are shown in nanoseconds an element; answers may still be laid out as pictures.
    """

    name: str
    scenes: Mapping[str, Any]
    reference: Callable[[Any], Array] | MonteCarlo
    metric: Metric
    candidates: Sequence[Candidate]
    mask: Mask = Mask()
    views: Callable[[str, Any], Mapping[str, Any]] = _one_view
    setup: Callable[[Case], Any] = _case
    compose: Callable[[Any, Any], Array] = _same
    also: Mapping[str, Callable[[Array, Array, Any], Any]] = field(default_factory=dict)
    display: Callable[[Any, Array], Array] | None = None
    plan: Callable[[Case], Any] | None = None
    size: tuple[int, int] = (640, 360)
    about: str = ""
    causes: bool = True
    max_error: float = 0.02
    element: str = "pixel"
    cost: str = "time"

    def __post_init__(self) -> None:
        if isinstance(self.reference, MonteCarlo) and self.metric.aggregate != "rms":
            raise ValueError(
                f"metric: expected aggregate 'rms' with a Monte Carlo reference, got {self.metric.aggregate!r}"
            )
        names = [c.name for c in self.candidates]
        twice = sorted({n for n in names if names.count(n) > 1})
        if twice:
            raise ValueError(f"candidates: expected each name once, got {twice[0]!r} twice")
