"""Vectors of rationals: the oracle of geometry."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

Vector = list[Fraction]


def vector(v: Iterable[Any]) -> Vector:
    """Floats as they are."""
    return [Fraction(float(x)) for x in v]


def sub(a: Sequence[Fraction], b: Sequence[Fraction]) -> Vector:
    """Subtract."""
    return [x - y for x, y in zip(a, b, strict=True)]


def along(a: Sequence[Fraction], d: Sequence[Fraction], t: Fraction) -> Vector:
    """Give `a + t d`."""
    return [x + t * y for x, y in zip(a, d, strict=True)]


def dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    """Scalar product."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction())


def cross(a: Sequence[Fraction], b: Sequence[Fraction]) -> Vector:
    """Cross product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def root(x: Fraction) -> Fraction:
    """Square root, to 60 digits."""
    with localcontext(prec=60, Emin=-9999, Emax=9999):
        return Fraction((Decimal(x.numerator) / Decimal(x.denominator)).sqrt())


def squared_to_segment(p: Vector, a: Vector, b: Vector) -> Fraction:
    """Square of the distance of a point from a segment."""
    d = sub(b, a)
    size = dot(d, d)
    t = min(max(dot(sub(p, a), d) / size, Fraction(0)), Fraction(1)) if size else Fraction(0)
    foot = sub(along(a, d, t), p)
    return dot(foot, foot)
