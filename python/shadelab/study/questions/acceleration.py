"""Acceleration: what each structure over triangles costs to build, to keep and to trace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...accel import BVH, BSPTree, Counts, Hit, KDTree, Octree, Structure, UniformGrid, brute_force
from ...mesh import Mesh
from ...scene import Scene
from ..question import Candidate, Case, Metric, Question
from ._acceleration_scenes import RAYS, SCENES

__all__ = ["question"]

Array = NDArray[Any]

_BUILDS = 5
"""Builds of which the median time is taken,"""

_PATIENCE_MS = 200.0
"""unless they took so long together."""

_CHECKED = 64
"""Rays of each case that are compared with brute force, too; all are compared between structures."""


@dataclass
class Built:
    """A structure over a case's mesh, what its build took, and what its rays cost."""

    structure: Structure
    build_ms: float
    counts: Counts
    out: Hit


@dataclass
class Inputs:
    """A mesh and rays through it; structures are built when first asked for, and kept."""

    positions: Array
    faces: NDArray[np.int32]
    origins: Array
    directions: Array
    built: dict[str, Built] = field(default_factory=dict)
    expected: Hit | None = None

    def structure(self, make: Callable[..., Structure], knobs: dict[str, Any]) -> Built:
        """A structure with these knobs; its answers are checked once."""
        name = f"{make.__name__}{sorted(knobs.items())}"
        if name not in self.built:
            structure = make(self.positions, self.faces, **knobs)
            times = [structure.stats().build_ms]
            # Slow builds once.
            while len(times) < _BUILDS and sum(times) < _PATIENCE_MS:
                times.append(make(self.positions, self.faces, **knobs).stats().build_ms)
            hit = structure.closest_hit(self.origins, self.directions)
            self._check(name, hit)
            counts = structure.counts(self.origins, self.directions)
            self.built[name] = Built(structure, float(np.median(times)), counts, hit)
        return self.built[name]

    def _check(self, name: str, hit: Hit) -> None:
        """Refuses hits that are not brute force's, or another structure's, to the bit."""
        if self.expected is None:
            some = np.random.default_rng(0).integers(hit.t.size, size=_CHECKED)
            o, d = (a.reshape(-1, 3)[some] for a in (self.origins, self.directions))
            exact = brute_force(self.positions, self.faces, o, d)
            if any(a.reshape(-1)[some].tobytes() != b.tobytes() for a, b in zip(hit[:4], exact[:4], strict=True)):
                raise AssertionError(f"{name}: hits differ from brute force")
            self.expected = hit
        elif any(a.tobytes() != b.tobytes() for a, b in zip(hit[:4], self.expected[:4], strict=True)):
            raise AssertionError(f"{name}: hits differ from those of another structure")


def _setup(case: Case) -> Inputs:
    made: Any = case.scene
    if isinstance(made, Scene):
        made = made.flatten(np.float32)
    elif not isinstance(made, Mesh):
        raise TypeError(f"scene: expected {case.scene_name!r} to be a Mesh or a Scene, got {type(made).__name__}")
    if not len(made.faces):
        raise ValueError(f"scene: expected at least one face in {case.scene_name!r}")
    positions = np.asarray(made.positions, case.dtype)
    used = positions[made.faces.reshape(-1)].astype(np.float64)
    rng = np.random.default_rng(case.seed)
    origins, directions = (np.ascontiguousarray(a, case.dtype) for a in case.view(used, case.size, rng))
    return Inputs(positions, made.faces, origins, directions)


def _candidate(name: str, make: Callable[..., Structure], about: str, knobs: Any = ()) -> Candidate:
    def run(inputs: Inputs, _: None, **given: Any) -> Array:
        built = inputs.structure(make, given)
        built.structure.closest_hit(inputs.origins, inputs.directions, out=built.out)
        return np.array([built.build_ms])

    def counters(inputs: Inputs, **given: Any) -> dict[str, float]:
        built = inputs.structure(make, given)
        boxes, triangles = (float(c.mean()) for c in built.counts)
        return {
            "boxes/ray": round(boxes, 1),
            "triangles/ray": round(triangles, 1),
            "bytes/face": round(built.structure.stats().bytes / len(inputs.faces), 1),
        }

    return Candidate(name, run, knobs or [{}], counters=counters, about=about)


def _candidates() -> list[Candidate]:
    return [
        _candidate(
            "BVH",
            BVH,
            "A hierarchy of boxes, eight children a node: each triangle stands once, boxes may overlap. The structure "
            "of this library that is made for speed; the others are lessons.",
            [{"method": m} for m in ("sah", "lbvh")],
        ),
        _candidate(
            "grid",
            UniformGrid,
            "Equal cells: no tree at all. Right where triangles are of one size and spread evenly; a dense object in a "
            "large scene falls into one cell.",
            [{"cells_per_face": 4.0}],
        ),
        _candidate(
            "octree",
            Octree,
            "Cells halved on all three axes where there are many triangles: adapts to where detail is, not to its "
            "shape.",
            [{"leaf_size": 8}],
        ),
        _candidate(
            "kd-tree",
            KDTree,
            "Planes across axes, put where they pay most (sah) or at the median: cuts off empty space, and triangles "
            "stand in many leaves.",
            [{"method": m} for m in ("sah", "median")],
        ),
        _candidate(
            "BSP tree",
            BSPTree,
            "Cells halved across x, y and z in turn; or by the planes of triangles, which also order them for "
            "painters.",
            [{"method": m} for m in ("axis_aligned", "polygon_aligned")],
        ),
    ]


_ABOUT = f"""All structures give the same hits to the bit, so nothing is lost in accuracy: what one pays is time before
the first ray, memory, and time for each ray. Which structure for which mesh? Each traces the same rays through about
6000 triangles, a picture's (traced together where a structure can) and random ones. Meshes are made so that
structures differ: even, clustered, of long thin triangles, of shells down to a billionth, and the famous teapot in a
stadium, a finely meshed thing (here a torus) amid few large ones. The error of this page is the time of the build,
the median of up to {_BUILDS}: what stands to be saved where a mesh moves."""

_METRIC_ABOUT = """Milliseconds that the build takes, from arrays to a structure that answers. Hits are checked: equal
between all structures, and to brute force on some rays of each case."""


def _price(value: Array, reference: Array, inputs: Inputs) -> Array:
    return value - reference


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "acceleration",
        SCENES,
        lambda inputs: np.zeros(1),
        Metric("time of the build", _price, "ms", _line(_METRIC_ABOUT), "max", word="build time"),
        _candidates(),
        views=lambda name, scene: RAYS,
        setup=_setup,
        size=(96, 54),
        about=_line(_ABOUT),
        causes=False,
        max_error=100.0,
    )


def _line(text: str) -> str:
    return " ".join(text.split())
