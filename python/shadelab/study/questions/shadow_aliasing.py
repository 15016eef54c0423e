"""Shadow aliasing: how the steps of a map's texels fall with its resolution, near and far."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import shadow
from ...light import DirectionalLight
from ...scene import Scene
from ..question import Candidate, Question
from ._visibility import BREAKING, EDGES, display, line, lit_error, near_and_far, pointlike, spread, traced
from .soft_shadows import MOMENT_BIAS, Inputs, _counters, _maps, _moment_maps, _page_counters, _pages

__all__ = ["question"]

Array = NDArray[Any]

_RESOLUTIONS = (256, 512, 1024, 2048, 4096)


def _hard(inputs: Inputs, maps: list[Any], resolution: int) -> Array:
    return np.stack([shadow.hard(m, inputs.points, inputs.geometric) for m in maps])


def _pcf(inputs: Inputs, maps: list[Any], resolution: int, samples: int, radius: float) -> Array:
    each: dict[str, Any] = {"samples": samples, "radius": radius, "kernel": "grid", "bilinear": True, "seed": None}
    return np.stack([shadow.pcf(m, inputs.points, inputs.geometric, **each) for m in maps])


def _moment(inputs: Inputs, maps: list[Any], resolution: int, sigma: float) -> Array:
    how: dict[str, Any] = {"moment_bias": MOMENT_BIAS}
    return np.stack([shadow.moment(m, inputs.points, inputs.geometric, **how) for m in maps])


def _cascades(inputs: Inputs, resolution: int, count: int) -> list[Any]:
    """Maps of parts of the view, drawn each frame."""
    camera = inputs.camera
    forward = -np.asarray(camera.view(), np.float64)[2]
    depths = inputs.points @ forward[:3] + forward[3]
    height, width = inputs.covered.shape
    how: dict[str, Any] = {"count": count, "aspect": width / height, "method": "logarithmic"}
    how |= {"near": float(depths.min()) * 0.99, "far": float(depths.max()) * 1.01}
    mesh = inputs.caster_positions, inputs.caster_faces
    return [shadow.cascades(*mesh, l, camera, resolution, **how) for l in inputs.lights]


def _in_parts(inputs: Inputs, maps: list[Any], resolution: int, count: int) -> Array:
    return _hard(inputs, maps, resolution)


def _part_counters(inputs: Inputs, resolution: int, count: int) -> dict[str, float]:
    whole = _counters("hard")(inputs, resolution)
    return {**whole, "bytes": whole["bytes"] * count}


def _parallel(inputs: Inputs) -> str | None:
    parallel = all(isinstance(l, DirectionalLight) for l in inputs.lights)
    return None if parallel else "cascades part the view for parallel light, and this is another"


def _sunny() -> Scene:
    """The long view under parallel light from the same side."""
    scene = BREAKING["long view"]()
    return Scene(scene.instances, lights=(DirectionalLight((0.65, -0.65, -0.4), (3, 3, 3)),), camera=scene.camera)


_SCENES = {**BREAKING, "long view, sun": _sunny}


_ABOUT = """A shadow map answers for texels, a picture asks for pixels. Where a texel covers many pixels its outline
shows as steps, where it covers few, thin things fall between texels. How does the error fall with the map's resolution,
near and far, and what does a filter as wide as a few texels do to it,
and what do maps for parts of the view, or pages where it looks? The light has no extent here, so that the exact
shadow has edges; a filter's blur counts as error, as steps do. A single map covers what the picture shows."""

_METRIC = """Root mean square, over the mask, of the lit fraction's difference from what one exact ray from each pixel
says: 0.3 is a share of 9 % of the pixels on the wrong side of an edge."""


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "shadow aliasing",
        _SCENES,
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
                about="Four moments of depth, filtered by a Gaussian of one texel before the lookup. Where depths span "
                "far more than what casts, the bias that rounding asks for lets light through.",
            ),
            Candidate(
                "cascades",
                _in_parts,
                {"resolution": (512, 1024, 2048), "count": (4,)},
                _cascades,
                _part_counters,
                _parallel,
                about="Four maps for parts of the view of equal ratio, one comparison: texels grow with pixels.",
            ),
            Candidate(
                "pages",
                lambda inputs, maps, resolution, per_pixel: _hard(inputs, maps, resolution),
                {"resolution": (4096, 16384), "per_pixel": (1, 4)},
                lambda inputs, **knobs: _pages(inputs, border=8, **knobs),
                lambda inputs, **knobs: _page_counters("hard")(inputs, border=8, **knobs),
                about="One comparison in pages of a large map, drawn where the view looks, in so many texels along a "
                "pixel as the whole map has.",
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
