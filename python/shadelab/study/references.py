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
    """A digest of content: numbers, texts, arrays, containers, dataclasses, functions with what they close over.

    None if something in it cannot be told by content; it is then not cached.
    """
    state = hashlib.sha256()
    try:
        for thing in things:
            _feed(state, thing, 0)
    except _Unknown:
        return None
    return state.hexdigest()


def _feed(state: Any, thing: Any, depth: int) -> None:
    if depth > 30:
        raise _Unknown
    state.update(f"<{type(thing).__module__}.{type(thing).__qualname__}".encode())
    if thing is None or isinstance(thing, bool | int | float | complex | str | bytes | np.dtype | np.generic | Path):
        state.update(repr(thing).encode())
    elif isinstance(thing, np.ndarray):
        if thing.dtype.kind == "O":
            raise _Unknown
        state.update(f"{thing.dtype.str}{thing.shape}".encode())
        state.update(np.ascontiguousarray(thing).tobytes())
    elif isinstance(thing, dict | types.MappingProxyType):
        for key, value in thing.items():
            _feed(state, key, depth + 1)
            _feed(state, value, depth + 1)
    elif isinstance(thing, list | tuple):
        for value in thing:
            _feed(state, value, depth + 1)
    elif dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        for field in dataclasses.fields(thing):
            state.update(field.name.encode())
            _feed(state, getattr(thing, field.name), depth + 1)
    elif isinstance(thing, types.FunctionType):
        _feed_code(state, thing.__code__)
        _feed(state, thing.__defaults__, depth + 1)
        for cell in thing.__closure__ or ():
            _feed(state, cell.cell_contents, depth + 1)
    elif isinstance(thing, types.ModuleType | type | types.BuiltinFunctionType):
        state.update(f"{thing.__name__}".encode())
    else:
        raise _Unknown
    state.update(b">")


def _feed_code(state: Any, code: types.CodeType) -> None:
    state.update(code.co_code)
    state.update(repr(code.co_names).encode())
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            _feed_code(state, constant)
        else:
            state.update(repr(constant).encode())


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
