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


def cost(technique: str, *, itemsize: int = 4, **knobs: Any) -> Cost:
    """What a technique of this chapter asks for one receiver, whatever the machine.

    Parameters
    ----------
    technique : {"hard", "pcf", "pcss", "ray_traced"}
        The function's name.
    itemsize : int
        Bytes of a texel.
    **knobs
        The function's own arguments; those that do not matter to the cost are ignored.

    Returns
    -------
    Cost

    Raises
    ------
    ValueError
        If there is no such technique.

    Examples
    --------
    >>> cost("pcss", blocker_samples=16, filter_samples=32)
    Cost(texel_reads=48, rays=0, bytes=192)
    """
    _arrays.choice("technique", technique, ("hard", "pcf", "pcss", "ray_traced"))
    if technique == "ray_traced":
        return Cost(0, int(knobs.get("samples", 16)), 0)
    if technique == "hard":
        reads = 1
    elif technique == "pcf":
        reads = int(knobs.get("samples", 16))
    else:
        reads = int(knobs.get("blocker_samples", 16)) + int(knobs.get("filter_samples", 32))
    return Cost(reads, 0, reads * itemsize)
