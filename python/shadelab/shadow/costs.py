"""What a lookup asks of any machine."""

from __future__ import annotations

from typing import Any, NamedTuple

from .. import _arrays

__all__ = ["Cost", "cost"]


class Cost(NamedTuple):
    """What a lookup asks of any machine, for one receiver."""

    texel_reads: int
    """The most texels read; `pcss` stops after the search where nothing blocks."""
    rays: int
    """Shadow rays."""
    bytes: int
    """The most bytes read from the map."""


_COMPARED = ("hard", "pcf", "pcss", "ray_traced", "distance_field")
_FILTERED = ("variance", "exponential_variance", "moment", "variance_soft")
# Texels of one lookup by the map's filter: between four, between four of two levels, four nodes of a table at four
# corners.
_READS = {"none": 4, "gaussian": 4, "mip": 8, "summed_area": 16}


def cost(technique: str, *, itemsize: int = 4, **knobs: Any) -> Cost:
    """What a technique of this chapter asks for one receiver, whatever the machine.

    Parameters
    ----------
    technique : {"hard", "pcf", "pcss", "ray_traced", "distance_field", "variance", ...}
        The function's name: of a lookup of this chapter.
    itemsize : int
        Bytes of a number in a texel.
    **knobs
        The function's own arguments, and those of `moment_map` (`kind`, `filter`, `bits`, `exponents`) or of
        `shadow_map` (`bits`); those that do not matter to the cost are ignored.

    Returns
    -------
    Cost

    Raises
    ------
    TypeError, ValueError
        If there is no such technique, or a count is not one.

    Examples
    --------
    >>> cost("pcss", blocker_samples=16, filter_samples=32)
    Cost(texel_reads=48, rays=0, bytes=192)
    >>> cost("moment", filter="mip", bits=16)
    Cost(texel_reads=8, rays=0, bytes=64)
    >>> cost("pcf", samples=16, bits=16)
    Cost(texel_reads=16, rays=0, bytes=32)
    """
    _arrays.choice("technique", technique, (*_COMPARED, *_FILTERED))
    itemsize = _arrays.count("itemsize", itemsize, 1)
    if technique == "ray_traced":
        return Cost(0, _count(knobs, "samples", 16), 0)
    if technique in _FILTERED:
        return _of_moments(technique, itemsize, knobs)
    if technique == "hard":
        reads = 1
    elif technique == "distance_field":
        # Eight nodes a step; the kernel takes some tens of steps where there is something to find.
        reads = 8 * _count(knobs, "max_steps", 128)
    elif technique == "pcf":
        reads = _count(knobs, "samples", 16) * (4 if knobs.get("bilinear") else 1)
    else:
        reads = _count(knobs, "blocker_samples", 16) + _count(knobs, "filter_samples", 32)
    # Stored depths: 24 bits lie in 32.
    size = {16: 2, 24: 4, 32: 4}.get(knobs.get("bits", 0), itemsize)
    return Cost(reads, 0, reads * size)


def _count(knobs: dict[str, Any], name: str, usual: int) -> int:
    """A knob that counts; whole numbers may come as floats."""
    value = knobs.get(name, usual)
    return _arrays.count(name, value, 0) if isinstance(value, int) else int(_arrays.number(name, value, 0.0))


def _of_moments(technique: str, itemsize: int, knobs: dict[str, Any]) -> Cost:
    kind = knobs.get("kind", "moment" if technique == "variance_soft" else technique)
    chosen = "mip" if technique == "variance_soft" else "gaussian"
    filter = knobs.get("filter", chosen)
    reads = _READS[_arrays.choice("filter", filter, tuple(_READS))] * (2 if technique == "variance_soft" else 1)
    channels = 4 if kind == "moment" or (kind == "exponential_variance" and _both(knobs)) else 2
    size = 2 if knobs.get("bits") == 16 else itemsize
    if filter == "summed_area" and knobs.get("precision", "double") == "double":
        size = 8
    return Cost(reads, 0, reads * channels * size)


def _both(knobs: dict[str, Any]) -> bool:
    exponents = knobs.get("exponents", (40.0, 5.0))
    return not isinstance(exponents, (int, float)) and len(exponents) == 2
