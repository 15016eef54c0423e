"""Shadow bias: acne against detached shadows, by kind and size of what a receiver is granted."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import shadow
from ..question import Candidate, Mask, Metric, Question
from ._shadow_scenes import own_camera
from ._visibility import BREAKING, display, facing, line, pointlike, spread, traced
from .soft_shadows import Inputs, _counters, _maps

__all__ = ["question"]

Array = NDArray[Any]

_RESOLUTION = 1024


def _lookup(**fixed: Any) -> Any:
    def run(inputs: Inputs, maps: list[Any], resolution: int, surface: str = "first", **knobs: float) -> Array:
        return np.stack([shadow.hard(m, inputs.points, inputs.geometric, **(fixed | knobs)) for m in maps])

    return run


def _residual(value: Array, reference: Array, inputs: Inputs) -> Array:
    return np.asarray(value - reference)


def _acne(value: Array, reference: Array, inputs: Inputs) -> float:
    """Share of the lit pixels that are darkened, in per cent."""
    seen = facing(inputs)
    return 100.0 * shadow.acne(value[seen], reference[seen])


def _detached(value: Array, reference: Array, inputs: Inputs) -> float:
    """Share of the shadowed pixels that are lit, in per cent."""
    seen = facing(inputs)
    return 100.0 * shadow.detached(value[seen], reference[seen])


_ABOUT = """A surface that a map has sampled at texels shadows itself between them: acne. What is granted to a receiver
against that, a blocker that is nearer than it no longer hides: its shadow detaches from its foot, and light leaks under
thin things. Which kind of bias, of which size, keeps both small at once? The light has no extent, the map 1024² texels;
outlines off by a fraction of a texel count on both sides and are the floor that no bias goes below."""

_METRIC = """Root of the share of pixels that would get light and are on the wrong side: 0.1 is 1 % of them."""

_NONE: dict[str, Any] = {"slope_bias": 0.0, "receiver_plane": False}


def _candidate(name: str, knobs: Any, about: str, **fixed: Any) -> Candidate:
    settings = {"resolution": (_RESOLUTION,)} | knobs
    return Candidate(name, _lookup(**fixed), settings, _maps, _counters("hard"), about=about)


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "shadow bias",
        BREAKING,
        traced,
        Metric("root of the share of wrong pixels", _residual, about=line(_METRIC), signs=("acne", "detached")),
        [
            _candidate("none", {}, "Depths compared as they are, up to rounding.", **_NONE),
            _candidate(
                "constant",
                {"bias": (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)},
                "A blocker must be nearer by so many world units: too much where surfaces face the light, too little "
                "where they slope.",
                **_NONE,
            ),
            _candidate(
                "slope",
                {"slope_bias": (0.25, 0.5, 1.0, 2.0, 4.0)},
                "Nearer by the depth that the receiver's plane gains over so many texels.",
                receiver_plane=False,
            ),
            _candidate(
                "normal offset",
                {"normal_offset": (0.25, 0.5, 1.0, 2.0, 4.0)},
                "Receivers move along their normal by so many texels times the sine of the light's angle: outlines "
                "move.",
                **_NONE,
            ),
            _candidate(
                "receiver plane",
                {"slope_bias": (0.0, 0.05, 0.5, 2.0)},
                "Compared with the receiver's tangent plane at the texel's centre: exact where it is flat, so that "
                "hardly any slope bias is needed.",
                receiver_plane=True,
            ),
            _candidate(
                "second depth",
                {"surface": ("second",)},
                "The map holds what lies behind the nearest surface: acne moves to what faces away from the light, and "
                "light leaks under what has no back.",
                **_NONE,
            ),
            _candidate(
                "midpoint",
                {"surface": ("midpoint",)},
                "The map holds the middle between the nearest surface and the next: as far from both as can be, but at "
                "silhouettes, where they meet.",
                **_NONE,
            ),
        ],
        Mask("all that faces the light", lambda reference, inputs: facing(inputs), "", "nothing faces the light"),
        setup=pointlike,
        views=own_camera,
        compose=spread,
        also={"acne %": _acne, "detached %": _detached},
        display=display,
        size=(320, 180),
        about=line(_ABOUT),
        max_error=0.15,
    )
