"""Shadow aliasing: how the steps of a map's texels fall with its resolution, near and far."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import shadow
from ..question import Candidate, Question
from ._visibility import BREAKING, EDGES, display, line, lit_error, near_and_far, pointlike, spread, traced
from .soft_shadows import Inputs, _counters, _maps, _moment_maps

__all__ = ["question"]

Array = NDArray[Any]

_RESOLUTIONS = (256, 512, 1024, 2048, 4096)


def _hard(inputs: Inputs, maps: list[Any], resolution: int) -> Array:
    return np.stack([shadow.hard(m, inputs.points, inputs.geometric) for m in maps])


def _pcf(inputs: Inputs, maps: list[Any], resolution: int, samples: int, radius: float) -> Array:
    each: dict[str, Any] = {"samples": samples, "radius": radius, "kernel": "grid", "bilinear": True, "seed": None}
    return np.stack([shadow.pcf(m, inputs.points, inputs.geometric, **each) for m in maps])


def _moment(inputs: Inputs, maps: list[Any], resolution: int, sigma: float) -> Array:
    return np.stack([shadow.moment(m, inputs.points, inputs.geometric) for m in maps])


_ABOUT = """A shadow map answers for texels, a picture asks for pixels. Where a texel covers many pixels its outline
shows as steps, where it covers few, thin things fall between texels. How does the error fall with the map's resolution,
near and far, and what does a filter as wide as a few texels do to it? The light has no extent here, so that the exact
shadow has edges; a filter's blur counts as error, as steps do. One map covers what the picture shows."""

_METRIC = """Root mean square, over the mask, of the lit fraction's difference from what one exact ray from each pixel
says: 0.3 is a share of 9 % of the pixels on the wrong side of an edge."""


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "shadow aliasing",
        BREAKING,
        traced,
        lit_error(_METRIC),
        [
            Candidate(
                "hard",
                _hard,
                {"resolution": _RESOLUTIONS},
                _maps,
                _counters("hard"),
                about="One comparison: steps as large as texels.",
            ),
            Candidate(
                "pcf",
                _pcf,
                {"resolution": _RESOLUTIONS, "samples": (4,), "radius": (1.0,)},
                _maps,
                lambda inputs, **knobs: _counters("pcf")(inputs, bilinear=True, **knobs),
                about="Four comparisons between four texels each: steps turn into ramps of two texels.",
            ),
            Candidate(
                "moment",
                _moment,
                {"resolution": _RESOLUTIONS[:-1], "sigma": (1.0,)},
                _moment_maps("moment"),
                _counters("moment"),
                about="Four moments of depth, filtered by a Gaussian of one texel before the lookup.",
            ),
        ],
        EDGES,
        near_and_far,
        pointlike,
        spread,
        {},
        display,
        size=(320, 180),
        about=line(_ABOUT),
        max_error=0.35,
    )
