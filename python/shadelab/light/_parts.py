"""What lights have in common: the numbers that they are given, checked, and as the kernels take them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, TypeAlias

from .. import _arrays

Vector: TypeAlias = tuple[float, float, float]

# Lengths whose squares are numbers in float32; and the brightest that a channel may be.
_LEAST, _MOST, _BRIGHTEST = 1e-15, 1e15, 1e30


def _freeze(light: Any, colors: str, skip: Sequence[str] = ()) -> None:
    """Turns what a light is given into finite floats and tuples of them; `colors` names the one that is a colour."""
    for each in fields(light):
        if each.name in skip:
            continue
        value = getattr(light, each.name)
        if each.type == "bool":
            object.__setattr__(light, each.name, _arrays.flag(each.name, value))
            continue
        if each.type == "float":
            object.__setattr__(light, each.name, _arrays.number(each.name, value))
            continue
        array = _arrays.array(each.name, value)
        if array.dtype.kind not in "fiu" or array.shape != (3,):
            raise ValueError(f"{each.name}: expected three numbers, got {value!r}")
        vector = tuple(_arrays.number(each.name, x) for x in array)
        if each.name == colors and min(vector) < 0:
            raise ValueError(f"{each.name}: expected no negative channel, got {vector}")
        if each.name == colors and max(vector) > _BRIGHTEST:
            raise ValueError(f"{each.name}: expected channels of at most {_BRIGHTEST:g}, got {vector}")
        object.__setattr__(light, each.name, vector)


def _nonzero(name: str, vector: Vector) -> None:
    if not any(vector):
        raise ValueError(f"{name}: expected a vector of non-zero length, got {vector}")


def _packed(*parts: Any) -> list[float]:
    """The length of what follows, then vectors and numbers, as the kernels take them: all vectors first."""
    numbers = [float(x) for part in parts for x in (part if isinstance(part, tuple) else (part,))]
    return [len(numbers), *numbers]
