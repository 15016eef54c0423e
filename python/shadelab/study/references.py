"""References: two independent halves, refined until they can judge, and kept by their content."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import os
import sys
import tempfile
import time
import types
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .machine import build, version
from .question import Case, MonteCarlo, Question

__all__ = ["Halves", "cache_directory", "digest", "first", "load", "refine", "store"]

CACHE_LIMIT = 1 << 30
"""Bytes that the cache of references may hold; the ones used longest ago go first."""


@dataclasses.dataclass
class Halves:
    """Two independent estimates of one reference; an exact one is both of its halves.

    `samples` is what each half holds where it matters, `base` what it holds elsewhere.
    """

    a: NDArray[Any]
    b: NDArray[Any]
    samples: int = 0
    base: int = 0
    seconds: float = 0.0
    cached: bool = False

    @property
    def exact(self) -> bool:
        """Whether there is no noise in it."""
        return self.samples == 0

    @property
    def mean(self) -> NDArray[Any]:
        """Both halves together."""
        return self.a if self.exact else (self.a + self.b) * self.a.dtype.type(0.5)


def _streams(seed: int) -> tuple[int, int]:
    """Seeds of the two halves; far from the small seeds that candidates are repeated with."""
    words = np.random.SeedSequence([seed, 0x5EED]).generate_state(2)
    return int(words[0]), int(words[1])


def first(question: Question, inputs: Any, seed: int) -> Halves:
    """The reference as it is before refinement."""
    begun = time.perf_counter()
    source = question.reference
    if not isinstance(source, MonteCarlo):
        exact = np.asarray(source(inputs))
        return Halves(exact, exact, seconds=time.perf_counter() - begun)
    a, b = (np.asarray(source.estimate(inputs, source.first, s, 0, None)) for s in _streams(seed))
    return Halves(a, b, source.first, source.first, time.perf_counter() - begun)


def refine(
    halves: Halves,
    source: MonteCarlo,
    inputs: Any,
    seed: int,
    where: NDArray[np.bool_],
    own: Any,
    target: float,
    cap: float,
) -> bool:
    """Refine the halves over `where` until `own(halves)` is at most `target`; False if `cap` seconds ran out first.

    Each step takes the samples that the square-root law asks for, at least as many as there are and as the time left
    allows.
    """
    begun = time.perf_counter()
    spent = halves.seconds
    rate = 0.0
    while (error := own(halves)) > target:
        n = halves.samples
        left = cap - (time.perf_counter() - begun)
        step = int(n * min((error / target) ** 2 if target > 0 else math.inf, 64.0)) - n
        step = max(step, n)
        if rate > 0:
            step = min(step, int(rate * left))
        else:
            step = n
        step = min(step, source.most - n)
        if left <= 0 or step < max(n // 8, 1):
            halves.seconds = spent + time.perf_counter() - begun
            return False
        at = time.perf_counter()
        for half, stream in zip((halves.a, halves.b), _streams(seed), strict=True):
            more = np.asarray(source.estimate(inputs, step, stream, n, where))
            half[where] += (more[where] - half[where]) * (step / (n + step))
        rate = step / max(time.perf_counter() - at, 1e-9)
        halves.samples = n + step
    halves.seconds = spent + time.perf_counter() - begun
    return True


# The cache ---------------------------------------------------------------------------------------------------------


def cache_directory() -> Path:
    """Where references are kept: SHADELAB_CACHE, or the system's place for caches."""
    asked = os.environ.get("SHADELAB_CACHE")
    if asked:
        return Path(asked)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "shadelab" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "shadelab"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "shadelab"


class _Unknown(Exception):
    """Something whose content cannot be told."""


def digest(*things: Any) -> str | None:
    """A digest of content: numbers, texts, arrays, containers, dataclasses, functions with all that they refer to.

    None if something in it cannot be told by content; it is then not cached.
    """
    feed = _Feed()
    try:
        for thing in things:
            feed(thing)
    except (_Unknown, RecursionError):
        return None
    return feed.state.hexdigest()


class _Feed:
    """Feeds things into a digest; functions once, since they may call each other in circles."""

    def __init__(self) -> None:
        self.state = hashlib.sha256()
        self.functions: set[types.FunctionType] = set()

    def __call__(self, thing: Any) -> None:
        self.state.update(f"<{type(thing).__module__}.{type(thing).__qualname__}".encode())
        if thing is None or isinstance(
            thing, bool | int | float | complex | str | bytes | np.dtype | np.generic | Path
        ):
            self.state.update(repr(thing).encode())
        elif isinstance(thing, np.ndarray):
            self._array(thing)
        elif isinstance(thing, dict | types.MappingProxyType):
            self.each(x for item in thing.items() for x in item)
        elif isinstance(thing, list | tuple):
            self.each(thing)
        elif dataclasses.is_dataclass(thing) and not isinstance(thing, type):
            self.each((f.name, getattr(thing, f.name)) for f in dataclasses.fields(thing))
        elif isinstance(thing, types.FunctionType):
            self._function(thing)
        elif isinstance(thing, types.ModuleType | type | types.BuiltinFunctionType | np.ufunc):
            self.state.update(thing.__name__.encode())
        else:
            raise _Unknown
        self.state.update(b">")

    def each(self, things: Iterable[Any]) -> None:
        for thing in things:
            self(thing)

    def _array(self, array: NDArray[Any]) -> None:
        if array.dtype.kind == "O":
            raise _Unknown
        self.state.update(f"{array.dtype.str}{array.shape}".encode())
        self.state.update(np.ascontiguousarray(array).tobytes())

    def _function(self, function: types.FunctionType) -> None:
        """Its code, its defaults, what it closes over, and the functions and data that it names."""
        if function in self.functions:
            return
        self.functions.add(function)
        names = self._code(function.__code__)
        self.each((function.__defaults__, function.__kwdefaults__))
        self.each(cell.cell_contents for cell in function.__closure__ or ())
        self.each((n, function.__globals__[n]) for n in sorted(names) if n in function.__globals__)

    def _code(self, code: types.CodeType) -> set[str]:
        """Feeds code; the names that it and the code within it use are returned."""
        self.state.update(code.co_code)
        names = set(code.co_names)
        for constant in code.co_consts:
            if isinstance(constant, types.CodeType):
                names |= self._code(constant)
            else:
                self.state.update(repr(constant).encode())
        return names


def key(question: Question, case: Case) -> str | None:
    """The name under which a case's reference is kept; None for an exact one or what cannot be told by content."""
    source = question.reference
    if not isinstance(source, MonteCarlo):
        return None
    about = (question.name, source.estimate, source.first, question.setup, question.mask.select)
    return digest("reference 1", version(), build(), np.__version__, about, case)


def load(name: str) -> Halves | None:
    """A kept reference; None if there is none that can be read."""
    path = cache_directory() / f"{name}.npz"
    try:
        with np.load(path, allow_pickle=False) as data:
            samples, base = (int(n) for n in data["samples"])
            halves = Halves(data["a"], data["b"], samples, base, float(data["seconds"]), cached=True)
        os.utime(path)
    except (OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
        return None
    return halves


def store(name: str, halves: Halves) -> bool:
    """Keep a reference; False if the cache cannot be written (a study goes on without)."""
    directory = cache_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(suffix=".tmp", dir=directory)
        try:
            with os.fdopen(handle, "wb") as file:
                counts = np.array([halves.samples, halves.base])
                np.savez(file, a=halves.a, b=halves.b, samples=counts, seconds=halves.seconds)
            os.replace(temporary, directory / f"{name}.npz")
        except BaseException:
            Path(temporary).unlink(missing_ok=True)
            raise
        _prune(directory)
    except OSError:
        return False
    return True


def _prune(directory: Path) -> None:
    files = sorted((p for p in directory.glob("*.npz")), key=lambda p: p.stat().st_mtime, reverse=True)
    total = 0
    for path in files:
        total += path.stat().st_size
        if total > CACHE_LIMIT:
            path.unlink(missing_ok=True)
