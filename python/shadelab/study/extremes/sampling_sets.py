"""Extremes of `sampling`: the last points of sequences, the ends of what samplers are asked."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ... import sampling
from ..._arrays import Floats
from ..stability import Measurement, extreme

_ENDS = (2**32 - 256, 2**32, 2**53 - 256, 2**64 - 256)


def _outside(points: Floats) -> int:
    return int((~((points >= 0) & (points < 1))).sum())


@extreme(
    "sampling.sobol",
    "the last points of 2^32 and of 2^64, scrambled and not",
    domain="256 points of 1,111 dimensions up to and from 2^32, up to 2^53 and 2^64",
    unit="count",
    claim=0,
)
def _end_of_sobol(dtype: np.dtype) -> Measurement:
    wrong, cases = 0, 0
    for start in _ENDS:
        for scramble in (None, "owen"):
            p = sampling.sobol(256, 1111, scramble=scramble, start=start, dtype=dtype)
            # An aligned block of 256 points has one in each 256th, in every dimension.
            cells = np.sort(np.floor(p.astype(np.float64) * 256), axis=0)
            wrong += int((cells != np.arange(256)[:, None]).sum()) + _outside(p)
            cases += p.size
    return Measurement(wrong, cases)


def _mirrored(index: int, base: int) -> Fraction:
    number, power = 0, 1
    while index:
        index, digit = divmod(index, base)
        number, power = number * base + digit, power * base
    return Fraction(number, power)


_SIEVE = [p for p in range(2, 8934) if all(p % q for q in range(2, int(p**0.5) + 1))]


@extreme(
    "sampling.halton",
    "the last points of 2^32 and of 2^64 against rationals",
    domain="3 points of 1,111 dimensions up to and from 2^32, up to 2^53 and 2^64",
    unit="absolute",
    claim={"float32": 1, "float64": 2},
)
def _end_of_halton(dtype: np.dtype) -> Measurement:
    unit, error, cases, strays = Fraction(float(np.finfo(dtype).eps) / 2), Fraction(0), 0, 0
    for end in (2**32, 2**32 + 3, 2**53, 2**64):
        p = sampling.halton(3, 1111, scramble=None, start=end - 3, dtype=dtype)
        strays += _outside(p)
        # Every seventh dimension, the first and the last: numbers below one, in its rounding units.
        for d in {0, 1, 2, *range(3, 1111, 7), 1110}:
            for i in range(3):
                error = max(error, abs(Fraction(float(p[i, d])) - _mirrored(end - 3 + i, _SIEVE[d])) / unit)
                cases += 1
    return Measurement(float(error), cases, strays)


@extreme(
    "sampling.halton",
    "scrambled strata at the last indices",
    domain="one period of bases 2, 3, 5, 29 and 541 at the last multiple of it below 2^32 and 2^64",
    unit="count",
    claim=0,
)
def _strata_of_halton(dtype: np.dtype) -> Measurement:
    wrong, cases = 0, 0
    for d in (0, 1, 2, 9, 99):
        base = _SIEVE[d]
        for end in (2**32, 2**64):
            for scramble in ("owen", "digits"):
                start = (end // base - 1) * base
                p = sampling.halton(base, d + 1, scramble=scramble, start=start, dtype=dtype)[:, d]
                strata = np.sort(np.floor(p.astype(np.float64) * base))
                wrong += int((strata != np.arange(base)).sum()) + _outside(p)
                cases += base
    return Measurement(wrong, cases)


@extreme(
    "sampling.r2",
    "the last points of 2^64 against steps of 2^-128",
    domain="4 points of 1, 2, 20 and 1,111 dimensions up to 2^32, 2^53 and 2^64",
    unit="count",
    claim=0,
)
def _end_of_r2(dtype: np.dtype) -> Measurement:
    wrong, cases, digits = 0, 0, {4: 24, 8: 53}[dtype.itemsize]
    for dimensions in (1, 2, 20, 1111):
        steps = sampling.sequences.golden_steps(dimensions)
        for end in (2**32, 2**53, 2**64):
            p = sampling.r2(4, dimensions, start=end - 4, dtype=dtype)
            exact = [[(2**127 + (end - 4 + i) * s) % 2**128 >> (128 - digits) for s in steps] for i in range(4)]
            wrong += int((p.astype(np.float64) * 2**digits != np.array(exact, np.float64)).sum())
            cases += p.size
    return Measurement(wrong, cases)


@extreme(
    "sampling.Sampler",
    "the ends of pixels, samples and dimensions, of every kind",
    domain="pixels to 2^64 - 1, samples and dimensions to 2^32 - 1, sets of 1 to 2^30 samples",
    unit="count",
    claim=0,
)
def _ends_of_samplers(dtype: np.dtype) -> Measurement:
    pixel = np.array([0, 1, 2**32, 2**64 - 1], np.uint64)
    other = np.array([0, 1, 2**31, 2**32 - 2, 2**32 - 1], np.uint64)
    wrong, cases = 0, 0
    kinds: tuple[sampling.SamplerKind, ...] = (
        "independent",
        "stratified",
        "latin_hypercube",
        "multi_jittered",
        "r2",
        "halton",
        "sobol",
    )
    for kind in kinds:
        for samples in (1, 2, 3, 1000, 2**30):
            for seed in (0, 2**64 - 1):
                sampler = sampling.Sampler(kind, seed, samples)
                u = sampler.uniform(pixel[:, None, None], other[:, None], other, dtype)
                wrong += _outside(u) + int((u.std((0, 1)) == 0).sum())
                cases += u.size
    return Measurement(wrong, cases)
