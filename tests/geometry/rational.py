"""Vectors of rationals, for tests against exact arithmetic."""

from fractions import Fraction

import mpmath


def vector(v):
    return [Fraction(float(x)) for x in v]


def add(a, b):
    return [x + y for x, y in zip(a, b, strict=True)]


def sub(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def times(a, s):
    return [x * s for x in a]


def dot(a, b):
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction())


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def root(x):
    """The square root, to 50 digits."""
    with mpmath.workdps(60):
        return mpmath.sqrt(mpmath.mpf(x.numerator) / x.denominator)


def nearest_on_segment(p, a, b):
    """The parameter of the point of a segment nearest to `p`."""
    d = sub(b, a)
    squared = dot(d, d)
    return min(max(dot(sub(p, a), d) / squared, Fraction(0)), Fraction(1)) if squared else Fraction(0)
