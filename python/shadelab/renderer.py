"""From a scene to a picture through the shortest list of passes, each with its reason.

`plan` looks at what a scene holds and decides which passes it requires; `render` runs them. Both also stand at the top:
`shadelab.plan`, `shadelab.render`.
"""

from __future__ import annotations

import html
import math
import struct
import time
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, color, light, mesh, raster, shadow
from ._arrays import Floats
from .accel import BVH

__all__ = ["Frame", "LeftOut", "Pass", "Plan", "plan", "render"]

_TECHNIQUES = ("hard", "pcf", "pcss", "ray_traced")
_RESOLUTIONS = (256, 512, 1024, 2048)


@dataclass(frozen=True)
class Pass:
    """One step of a frame: what it does, why the scene requires it, and with which settings."""

    name: str
    reason: str
    settings: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class LeftOut:
    """A pass that the scene does not require, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class Plan:
    """The passes of a frame in order, and what was left out."""

    passes: tuple[Pass, ...]
    left_out: tuple[LeftOut, ...]
    size: tuple[int, int]
    lights: int | None = None
    """How many lights the scene has that it was made for; None if it does not say."""

    def find(self, name: str) -> Pass | None:
        """The pass of a name, None if it was left out.

        Parameters
        ----------
        name : str
            As `Pass.name`.

        Returns
        -------
        Pass or None
        """
        return next((p for p in self.passes if p.name == name), None)

    def __str__(self) -> str:
        width = max((len(name) for name in [p.name for p in self.passes] + [x.name for x in self.left_out]), default=0)
        lines = [f"{self.size[0]} x {self.size[1]}, {len(self.passes)} passes"]
        for number, p in enumerate(self.passes, 1):
            settings = ", ".join(f"{k}={v!r}" for k, v in p.settings.items())
            lines.append(f"{number:3}. {p.name:{width}}  {p.reason}" + (f" ({settings})" if settings else ""))
        lines += [f"  -  {x.name:{width}}  left out: {x.reason}" for x in self.left_out]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = []
        for number, p in enumerate(self.passes, 1):
            settings = ", ".join(f"{k}={v!r}" for k, v in p.settings.items())
            rows.append((str(number), p.name, p.reason, settings))
        rows += [("–", x.name, f"left out: {x.reason}", "") for x in self.left_out]
        body = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>" for row in rows)
        head = "<tr><th></th><th>pass</th><th>reason</th><th>settings</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture with what it was made of. Arrays are (H, W) or (H, W, 3), row 0 at the top."""

    radiance: Floats
    """Linear radiance towards the eye, W/(m² sr)."""
    depth: Floats
    """Distance along the camera's axis; infinite where nothing is seen."""
    position: Floats
    """Points seen, in the world; NaN where nothing is seen."""
    normal: Floats
    """Shading normals, towards the eye; NaN where nothing is seen."""
    face: NDArray[np.int32]
    """Faces seen; -1 where nothing is seen."""
    lit: tuple[Floats, ...]
    """For each light of the scene the lit fraction: 1 where nothing is seen or the plan looks for no shadow."""
    times: Mapping[str, float]
    """Seconds by pass."""
    plan: Plan

    def display(self, exposure: float | None = None, tone_map: str = "aces") -> NDArray[np.uint8]:
        """The picture for a screen: exposed, tone-mapped, sRGB-encoded.

        Parameters
        ----------
        exposure : float, optional
            What radiance is multiplied by; by default what brings the 98th percentile of the luminance to 0.8.
        tone_map : str
            A method of `shadelab.color.tone_map`.

        Returns
        -------
        ndarray of uint8, shape (H, W, 3)

        Raises
        ------
        ValueError
            If the exposure is not positive or there is no such tone map.
        """
        if exposure is None:
            bright = color.luminance(self.radiance)
            peak = float(np.quantile(bright[np.isfinite(bright)], 0.98)) if bright.size else 0.0
            factor = 0.8 / peak if peak > 0 else 1.0
        else:
            factor = _arrays.number("exposure", exposure, above=0.0)
        mapped = color.tone_map(self.radiance * np.float32(factor), tone_map)  # type: ignore[arg-type]
        encoded = color.encode_transfer(np.clip(np.nan_to_num(mapped), 0, 1))
        return np.asarray(encoded * 255 + 0.5, np.uint8)

    def save(self, path: str | Path) -> None:
        """Write the picture: PNG as `display` shows it, EXR and HDR as radiance.

        Parameters
        ----------
        path : path
            Ends in .png, .exr or .hdr.

        Raises
        ------
        ImportError
            If the extra `io` is missing.
        OSError, ValueError
            If the file cannot be written, or has another ending.
        """
        from . import scene

        if Path(path).suffix.lower() == ".png":
            Path(path).write_bytes(self._repr_png_())
        else:
            scene.save_image(path, self.radiance)

    def _repr_png_(self) -> bytes:
        """The displayed picture as a PNG file (ISO/IEC 15948), which Jupyter shows."""
        pixels = self.display()
        height, width = pixels.shape[:2]
        # Each row begins with its filter: 0, none.
        rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)

        def chunk(kind: bytes, data: bytes) -> bytes:
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
        body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b"")
        return b"\x89PNG\r\n\x1a\n" + body


@dataclass(frozen=True)
class _Facts:
    """What a plan asks about a scene, computed once."""

    positions: NDArray[np.float64]
    faces: NDArray[np.int32]
    eye: NDArray[np.float64]
    pixel: float
    """Size of a pixel at unit distance."""
    nearest: float
    """Least distance of the scene's bounds from the eye."""
    extent: float
    """Diagonal of the scene's bounds."""
    unshadowed: str
    """Why nothing in the scene can shade anything else; empty if something can."""


def _facts(scene: Any, size: tuple[int, int]) -> _Facts:
    arrays = scene.flatten(np.float32)
    positions, faces = arrays.positions.astype(np.float64), arrays.faces
    eye = np.asarray(scene.camera.eye, np.float64)
    used = positions[np.unique(faces)] if len(faces) else np.zeros((1, 3))
    low, high = used.min(0), used.max(0)
    nearest = float(np.linalg.norm(np.maximum(np.maximum(low - eye, eye - high), 0.0)))
    pixel = 2.0 * math.tan(float(scene.camera.fov_y) / 2.0) / size[1]
    extent = float(np.linalg.norm(high - low))
    if not len(faces):
        reason = "the scene has no surfaces"
    elif _is_flat(used, extent):
        reason = "all surfaces lie in one plane"
    elif _is_convex(positions, faces, eye, extent):
        reason = "the only body is convex, and cannot shade itself"
    else:
        reason = ""
    return _Facts(positions, faces, eye, pixel, nearest, extent, reason)


def _is_flat(points: NDArray[np.float64], extent: float) -> bool:
    centred = points - points.mean(0)
    normal = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return bool(np.abs(centred @ normal).max() <= 1e-6 * extent)


def _is_convex(
    positions: NDArray[np.float64], faces: NDArray[np.int32], eye: NDArray[np.float64], extent: float
) -> bool:
    """Whether the faces form one closed convex surface, seen from outside.

    A closed surface that is convex at every edge consists of convex bodies, each of Euler characteristic 2.
    """
    if not 4 <= len(faces) <= 200_000:
        return False
    # Vertices that were split for normals or texture coordinates are one.
    points, welded = np.unique(positions, axis=0, return_inverse=True)
    f = welded.reshape(-1)[faces]
    start, end = f.reshape(-1), np.roll(f, -1, axis=1).reshape(-1)
    opposite = np.roll(f, -2, axis=1).reshape(-1)
    key, reverse = start * len(points) + end, end * len(points) + start
    order = np.argsort(key)
    at = np.searchsorted(key[order], reverse)
    if len(np.unique(key)) != len(key) or (at == len(key)).any() or (key[order[at]] != reverse).any():
        return False
    if len(np.unique(f)) - len(key) // 2 + len(f) != 2:
        return False
    normals = np.cross(points[f[:, 1]] - points[f[:, 0]], points[f[:, 2]] - points[f[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
    across = points[opposite[order[at]]] - points[start]
    rises = np.einsum("ij,ij->i", across, np.repeat(normals, 3, axis=0))
    outside = np.einsum("ij,ij->i", eye - points[f[:, 0]], normals) > 0
    return bool(rises.max() <= 1e-6 * extent and outside.any())


def _brightness(lamp: Any) -> float:
    emitted = next(getattr(lamp, n) for n in ("radiance", "intensity", "irradiance") if hasattr(lamp, n))
    return float(np.max(emitted))


def _rect_depths(lamp: light.RectLight, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    axis = np.cross(lamp.edge_u, lamp.edge_v)
    return np.asarray((positions - np.asarray(lamp.center)) @ (axis / np.linalg.norm(axis)))


def _unlit(lamp: Any, facts: _Facts) -> str:
    """Why a light reaches nothing; empty if it may."""
    if _brightness(lamp) == 0.0:
        return "it emits nothing"
    if isinstance(lamp, light.RectLight) and not lamp.two_sided:
        depths = _rect_depths(lamp, facts.positions[np.unique(facts.faces)])
        if depths.max(initial=-math.inf) <= 1e-6 * facts.extent:
            return "it faces away from every surface"
    return ""


def _beyond_one_map(lamp: Any, facts: _Facts) -> str:
    """Why one shadow map cannot see what a light shines on; empty if it can."""
    used = facts.positions[np.unique(facts.faces)]
    if isinstance(lamp, light.RectLight):
        if lamp.two_sided and _rect_depths(lamp, used).min() < -1e-6 * facts.extent:
            return "the light shines to both sides, and a map sees one"
    elif isinstance(lamp, light.PointLight):
        # Whether the bounds' corners lie in the cone of a map towards their middle.
        low, high = used.min(0), used.max(0)
        corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, -1).T
        away, axis = corners - lamp.position, (low + high) / 2 - lamp.position
        along, length = away @ axis, np.linalg.norm(away, axis=-1) * np.linalg.norm(axis)
        if (along <= length * math.cos(math.radians(65.0))).any():
            return "the light stands close to or within the scene, and one map cannot see all around"
    return ""


def _widest_penumbra(lamp: light.RectLight, facts: _Facts) -> float:
    """A bound by similar triangles: the nearest blocker over the farthest receiver."""
    depths = _rect_depths(lamp, facts.positions[np.unique(facts.faces)])
    if depths.min() <= 0.0:
        return math.inf
    side = max(float(np.linalg.norm(lamp.edge_u)), float(np.linalg.norm(lamp.edge_v)))
    return side * float(depths.max() / depths.min() - 1.0)


def _resolution(facts: _Facts) -> int:
    """The least resolution whose texels are no larger than a pixel at the scene's middle."""
    distance = facts.nearest + facts.extent / 2
    texels = facts.extent / max(distance * facts.pixel, 1e-30)
    return next((r for r in _RESOLUTIONS if r >= texels), _RESOLUTIONS[-1])


def _picked(evidence: Any, max_error: float | None, budget_ms: float | None) -> tuple[str, dict[str, Any], str]:
    """Technique, settings and reason, as a study measured them."""
    bounds = {"max_error": max_error, "budget_ms": budget_ms}
    asked = {k: _arrays.number(k, v, above=0.0) for k, v in bounds.items() if v is not None}
    if not asked:
        raise ValueError("evidence: expected max_error or budget_ms beside it")
    if not callable(getattr(evidence, "pick", None)):
        raise TypeError(f"evidence: expected the result of a study, got {type(evidence).__name__}")
    choice = evidence.pick(**asked)
    if choice is None:
        raise ValueError(f"evidence: nothing that was measured keeps {asked}")
    if choice.technique not in _TECHNIQUES:
        raise ValueError(f"evidence: expected a technique among {', '.join(_TECHNIQUES)}, got {choice.technique!r}")
    wanted = " and ".join(f"{k} {v:g}" for k, v in asked.items())
    reason = f"measured: error {choice.error:.3g} in {choice.ms:.3g} ms, the choice for {wanted}"
    return choice.technique, dict(choice.knobs), reason


def _shadow_passes(
    lamp: Any, suffix: str, facts: _Facts, measured: tuple[str, dict[str, Any], str] | None
) -> tuple[list[Pass], list[LeftOut]]:
    """How the shadow of one light is found, for a light that reaches something."""
    if facts.unshadowed:
        return [], [LeftOut(f"shadow{suffix}", facts.unshadowed)]
    left_out: list[LeftOut] = []
    settings: dict[str, Any] = {}
    width, footprint = 0.0, facts.nearest * facts.pixel
    if isinstance(lamp, light.RectLight):
        width = _widest_penumbra(lamp, facts)
    if not isinstance(lamp, light.RectLight):
        technique, reason = "hard", "the light has no extent: its shadows have no penumbra"
        left_out.append(LeftOut(f"penumbra{suffix}", "no area light: a hard shadow suffices"))
    elif width < footprint:
        technique = "hard"
        reason = f"penumbrae are at most {width:.2g} wide, less than a pixel ({footprint:.2g})"
        left_out.append(LeftOut(f"penumbra{suffix}", "narrower than a pixel: a hard shadow suffices"))
    elif measured is not None:
        technique, settings, reason = measured
    else:
        technique, settings = "pcss", {"blocker_samples": 16, "filter_samples": 32}
        reason = "an area light, with penumbrae as wide as " + (
            f"{width / footprint:.0f} pixels" if math.isfinite(width) and footprint > 0 else "the light itself"
        )

    settings = dict(settings)
    resolution = settings.pop("resolution", None)
    beyond = _beyond_one_map(lamp, facts) if technique != "ray_traced" else ""
    if beyond:
        samples = 16 if isinstance(lamp, light.RectLight) else 1
        technique, settings, reason = "ray_traced", {"samples": samples}, beyond
    if technique == "ray_traced":
        left_out.append(LeftOut(f"shadow map{suffix}", "rays need none"))
        return [Pass(f"shadow{suffix}", reason, {"technique": technique, **settings})], left_out
    if resolution is None:
        resolution, why = _resolution(facts), "texels no larger than pixels where the resolution allows"
    else:
        why = "the resolution that was measured"
    return [
        Pass(f"shadow map{suffix}", f"what the light sees; {why}", {"resolution": int(resolution)}),
        Pass(f"shadow{suffix}", reason, {"technique": technique, **settings}),
    ], left_out


def plan(
    scene: Any,
    size: tuple[int, int] = (1280, 720),
    *,
    max_error: float | None = None,
    budget_ms: float | None = None,
    evidence: Any = None,
) -> Plan:
    """The shortest list of passes that a scene requires, each with its reason.

    Parameters
    ----------
    scene : Scene
        What is to be rendered.
    size : (int, int)
        Width and height in pixels: what is smaller than a pixel is not worth a pass.
    max_error, budget_ms : float, optional
        Bounds that the shadow technique of area lights must keep, as measured in `evidence`.
    evidence : object, optional
        What a study found: anything whose ``pick(max_error=…)`` or ``pick(budget_ms=…)`` returns an object with
        `technique`, `knobs`, `error` and `ms`.

    Returns
    -------
    Plan
        Passes in order, and what was left out and why. Prints as text, shows as a table in Jupyter.

    Raises
    ------
    TypeError, ValueError
        If a size or bound is out of range, a bound comes without evidence, or no measured candidate keeps it.

    Notes
    -----
    Decided by necessity: no pass without surfaces, lights, or something that can stand between them (one plane and
    one convex body shade nothing); no map for a light that emits nothing or faces away; no penumbra for lights without
    extent or where similar triangles bound it below a pixel. Bounds are on the safe side: a pass may be there without
    need, never missing with need. Costs a few milliseconds a 100 000 triangles.

    Examples
    --------
    >>> from shadelab.mesh import box
    >>> from shadelab.light import PointLight
    >>> from shadelab.scene import Scene
    >>> print("; ".join(p.name for p in plan(Scene([box()], [PointLight((0, 5, 0), (9, 9, 9))])).passes))
    g-buffer; direct light
    """
    _check_scene(scene)
    size = _checked_size(size)
    if evidence is None and not (max_error is None and budget_ms is None):
        raise ValueError("evidence: expected the result of a study beside max_error or budget_ms")
    measured = _picked(evidence, max_error, budget_ms) if evidence is not None else None
    _arrays.warn_if_coarse(scene.flatten(np.float32).positions, np.float32, 3)
    return _decided(scene, size, measured)


def _decided(scene: Any, size: tuple[int, int], measured: tuple[str, dict[str, Any], str] | None) -> Plan:
    facts = _facts(scene, size)
    passes: list[Pass] = []
    left_out: list[LeftOut] = []
    lamps = list(scene.lights)
    if not len(facts.faces):
        left_out += [LeftOut(n, "the scene has no surfaces") for n in ("g-buffer", "shadow", "direct light", "ambient")]
        passes.append(Pass("background", "all that is seen"))
        left_out += _light_surfaces(scene, size)
        return Plan(tuple(passes), tuple(left_out), size, len(lamps))

    passes.append(Pass("g-buffer", "which surface each pixel sees: everything else is done once a pixel"))
    reaching = []
    traced = False
    for i, lamp in enumerate(lamps):
        suffix = f" {i}" if len(lamps) > 1 else ""
        unlit = _unlit(lamp, facts)
        if unlit:
            left_out += [LeftOut(f"{n}{suffix}", unlit) for n in ("shadow map", "direct light")]
            continue
        reaching.append(i)
        more, less = _shadow_passes(lamp, suffix, facts, measured)
        if not traced and any(p.settings.get("technique") == "ray_traced" for p in more):
            passes.append(Pass("bvh", "shadow rays are traced in it"))
            traced = True
        passes += more
        left_out += less
    if reaching:
        count = "a light reaches" if len(reaching) == 1 else f"{len(reaching)} lights reach"
        passes.append(Pass("direct light", f"{count} the scene", {"lights": tuple(reaching), "samples": 16}))
    elif not lamps:
        left_out.append(LeftOut("direct light", "the scene has no lights"))
    left_out += _light_surfaces(scene, size)
    passes, left_out = _surroundings(scene, passes, left_out)
    left_out.append(LeftOut("tone map", "a matter of display: the frame stays linear"))
    return Plan(tuple(passes), tuple(left_out), size, len(lamps))


def _check_scene(scene: Any) -> None:
    from .scene import Scene

    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene, got {type(scene).__name__}")


def _checked_size(size: Any) -> tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        kind: type[Exception] = TypeError if np.ndim(size) == 0 else ValueError
        raise kind(f"size: expected (width, height), got {size!r}") from None
    return _arrays.count("size", width, 1, raster.MAX_SIZE), _arrays.count("size", height, 1, raster.MAX_SIZE)


def _light_surfaces(scene: Any, size: tuple[int, int]) -> list[LeftOut]:
    """The rectangular lights that may be in view: they shine, but no pass draws them."""
    camera, several = scene.camera, len(scene.lights) > 1
    eye, view = np.asarray(camera.eye, np.float64), np.asarray(camera.view(), np.float64)
    up = math.tan(float(camera.fov_y) / 2.0)
    aside = up * size[0] / size[1]
    found = []
    for i, lamp in enumerate(scene.lights):
        if not isinstance(lamp, light.RectLight) or _brightness(lamp) == 0.0:
            continue
        if not lamp.two_sided and _rect_depths(lamp, eye[None])[0] <= 0.0:
            continue
        x, y, z = view[:3, :3] @ np.array(_corners(lamp)).T + view[:3, 3:]
        # Out of view if all corners are beyond one of the picture's sides.
        sides = (-z, x - aside * z, -x - aside * z, y - up * z, -y - up * z)
        if all((s > 0.0).any() for s in sides):
            suffix = f" {i}" if several else ""
            found.append(LeftOut(f"light surface{suffix}", "it is in view, but no pass draws lights: path_trace does"))
    return found


def _surroundings(scene: Any, passes: list[Pass], left_out: list[LeftOut]) -> tuple[list[Pass], list[LeftOut]]:
    if np.max(scene.background) > 0:
        passes.append(Pass("ambient", "the background shines on everything; nothing hides it from anything here"))
    else:
        left_out.append(LeftOut("ambient", "the background is black"))
    if np.max(scene.flatten(np.float32).emission, initial=0.0) > 0:
        passes.append(Pass("emission", "some materials shine"))
    else:
        left_out.append(LeftOut("emission", "no material shines"))
    return passes, left_out


@dataclass(frozen=True)
class _Seen:
    """The surfaces that pixels show; arrays of receivers hold the covered pixels alone, row by row."""

    face: NDArray[np.int32]
    covered: NDArray[np.bool_]
    points: Floats
    geometric: Floats
    shading: Floats
    base_color: Floats
    material: NDArray[np.int32]

    def spread(self, values: Floats, fill: float) -> Floats:
        """Values of receivers as a picture."""
        picture = np.full((*self.covered.shape, *values.shape[1:]), fill, values.dtype)
        picture[self.covered] = values
        return picture


def _g_buffer(arrays: Any, camera: Any, size: tuple[int, int]) -> _Seen:
    """Visible faces, points and normals; both sides of a surface are looked at as its front."""
    matrix = camera.projection(size[0] / size[1], depth="reversed") @ camera.view()
    positions = np.concatenate([arrays.positions, np.ones((len(arrays.positions), 1))], axis=-1)
    clip = (positions @ matrix.T).astype(np.float32)
    drawn = raster.g_buffer(
        clip,
        arrays.faces,
        arrays.positions,
        size,
        normals=arrays.normals,
        material_ids=arrays.material_ids,
        depth="reversed",
    )
    covered = drawn.face >= 0
    face, points, shading = drawn.face[covered], drawn.position[covered], drawn.normal[covered]
    geometric = np.nan_to_num(mesh.face_normals(arrays.positions, arrays.faces))[face]
    shading = np.where(shading.any(-1, keepdims=True), shading, geometric)
    away = points - np.asarray(camera.eye, np.float32)
    geometric = np.where(np.einsum("ij,ij->i", geometric, away)[:, None] > 0, -geometric, geometric)
    shading = np.where(np.einsum("ij,ij->i", shading, geometric)[:, None] < 0, -shading, shading)
    material = drawn.material[covered]
    base = arrays.base_color[material]
    if arrays.colors is not None:
        where = raster.Raster(drawn.face, drawn.u, drawn.v, drawn.depth)
        base = base * raster.interpolate(arrays.colors, arrays.faces, where)[covered]
    points, geometric, shading, base = (np.ascontiguousarray(x, np.float32) for x in (points, geometric, shading, base))
    return _Seen(drawn.face, covered, points, geometric, shading, base, material)


def _above_horizon(lamp: Any, seen: _Seen) -> NDArray[np.bool_]:
    """Whether any part of a light is above the plane of the surface itself, whatever the shading normal says."""
    n = seen.geometric
    if isinstance(lamp, light.DirectionalLight):
        # Of unit length before it is rounded: in single precision 1e-300 is nothing.
        direction = shadow._unit("direction", np.asarray(lamp.direction, np.float64))
        return np.asarray(n @ direction.astype(n.dtype) < 0)
    corners = [np.asarray(lamp.position)] if isinstance(lamp, light.PointLight) else _corners(lamp)
    here = np.einsum("ij,ij->i", seen.points, n)
    return np.asarray(np.max([n @ corner.astype(n.dtype) for corner in corners], axis=0) > here)


def _corners(lamp: light.RectLight) -> list[NDArray[np.float64]]:
    center, u, v = (np.asarray(x, np.float64) for x in (lamp.center, lamp.edge_u, lamp.edge_v))
    return [center + (a * u + b * v) / 2 for a in (-1, 1) for b in (-1, 1)]


def _lit(how: Pass, lamp: Any, seen: _Seen, chart: Any, bvh: BVH | None) -> Floats:
    """The lit fraction of every receiver by the technique of a pass."""
    knobs = dict(how.settings)
    technique = knobs.pop("technique")
    if technique == "ray_traced":
        assert bvh is not None
        return shadow.ray_traced(bvh, seen.points, seen.geometric, lamp, **knobs)
    techniques: dict[str, Callable[..., Any]] = {"hard": shadow.hard, "pcf": shadow.pcf, "pcss": shadow.pcss}
    return np.asarray(techniques[technique](chart, seen.points, seen.geometric, **knobs))


class _Clock:
    """Times passes and tells the caller how far the frame is."""

    def __init__(self, total: int, tell: Callable[[int, int], object] | None) -> None:
        self.times: dict[str, float] = {}
        self._total, self._tell, self._since = total, tell, time.perf_counter()

    def done(self, name: str) -> None:
        now = time.perf_counter()
        self.times[name] = now - self._since
        self._since = now
        if self._tell is not None:
            self._tell(len(self.times), self._total)


def render(
    scene: Any,
    plan: Plan | None = None,
    size: tuple[int, int] | None = None,
    *,
    seed: int = 0,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Frame:
    """A picture of a scene, by the passes of a plan.

    Parameters
    ----------
    scene : Scene
        What is rendered, in float32.
    plan : Plan, optional
        The passes; by default `plan(scene, size)`.
    size : (int, int), optional
        Width and height in pixels; by default those of the plan, or 1280 x 720.
    seed : int
        Of the noise in filters and samples: the same seed gives the same bits.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total) in passes.

    Returns
    -------
    Frame
        Radiance, G-buffer, lit fractions and the time of each pass; shows itself in Jupyter.

    Raises
    ------
    TypeError, ValueError
        If the plan does not fit the scene or the size, or an argument is out of range.

    Notes
    -----
    Direct light is what would arrive with nothing in between (`shadelab.light.unshadowed`: exact for diffuse
    reflection) times the lit fraction that the plan's technique finds, plus the background's light as if nothing
    hid it, plus emission. No light is reflected twice. Lights themselves are not seen, though
    `shadelab.pathtrace.path_trace` shows rectangles: the plan lists those in view as left out. Where a light is wholly
    visible the result is that of `shadelab.pathtrace.direct_light` up to the noise of glossy reflection.

    Examples
    --------
    >>> import shadelab as sl
    >>> frame = sl.render(sl.scene.default(), size=(64, 36))
    >>> frame.radiance.shape, [name for name in frame.times]  # doctest: +NORMALIZE_WHITESPACE
    ((36, 64, 3), ['g-buffer', 'shadow map', 'shadow', 'direct light', 'ambient'])
    """
    _check_scene(scene)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    chosen = _decided(scene, _checked_size((1280, 720) if size is None else size), None) if plan is None else plan
    _check_plan(chosen, scene, size)
    tell = _arrays.progress_callback(progress, "render")
    clock = _Clock(len(chosen.passes), tell)
    width, height = chosen.size
    background = np.asarray(scene.background, np.float32)
    lamps = list(scene.lights)
    arrays = scene.flatten(np.float32)
    _arrays.warn_if_coarse(arrays.positions, np.float32, 3)
    if chosen.find("g-buffer") is None:
        return _empty_frame(chosen, background, len(lamps), clock)

    seen = _g_buffer(arrays, scene.camera, chosen.size)
    clock.done("g-buffer")
    radiance = np.zeros_like(seen.points)
    fractions: dict[int, Floats] = {}
    chart, bvh = None, None
    for p in chosen.passes[1:]:
        kind, index = _split(p.name, lamps)
        if kind == "bvh":
            bvh = BVH(arrays.positions, arrays.faces)
        elif kind == "shadow map":
            chart = shadow.shadow_map(arrays.positions, arrays.faces, lamps[index], **p.settings, receivers=seen.points)
        elif kind == "shadow":
            seeded = p.settings.get("technique") != "hard" and "seed" not in p.settings
            how = Pass(p.name, p.reason, {**p.settings, "seed": seed}) if seeded else p
            fractions[index] = _lit(how, lamps[index], seen, chart, bvh)
        elif kind == "direct light":
            for i in p.settings["lights"]:
                fraction = fractions.setdefault(i, np.ones(len(seen.points), np.float32))
                fraction *= _above_horizon(lamps[i], seen)
                radiance += (
                    _unshadowed(lamps[i], seen, arrays, scene.camera, p.settings["samples"], seed) * fraction[:, None]
                )
        elif kind == "ambient":
            radiance += seen.base_color * background
        elif kind == "emission":
            radiance += arrays.emission[seen.material]
        else:
            raise ValueError(f"plan: there is no pass {p.name!r}")
        clock.done(p.name)

    picture = np.broadcast_to(background, (height, width, 3)).copy()
    picture[seen.covered] = radiance
    forward = -np.asarray(scene.camera.view())[2].astype(np.float64)
    depth = (seen.points @ forward[:3] + forward[3]).astype(np.float32)
    ones = np.ones(len(seen.points), np.float32)
    lit = tuple(seen.spread(fractions.get(i, ones), 1.0) for i in range(len(lamps)))
    return Frame(
        picture,
        seen.spread(depth, np.inf),
        seen.spread(seen.points, np.nan),
        seen.spread(seen.shading, np.nan),
        seen.face,
        lit,
        clock.times,
        chosen,
    )


def _check_plan(chosen: Any, scene: Any, size: Any) -> None:
    if not isinstance(chosen, Plan):
        raise TypeError(f"plan: expected a Plan, got {type(chosen).__name__}")
    if size is not None and _checked_size(size) != tuple(chosen.size):
        raise ValueError(f"plan: made for another size, {tuple(chosen.size)}, than {tuple(size)}")
    lights = len(scene.lights)
    if chosen.lights is not None and chosen.lights != lights:
        raise ValueError(f"plan: made for another scene, with {chosen.lights} lights instead of {lights}")
    for p in chosen.passes:
        wanted = p.settings.get("lights", (0,) if p.name in ("shadow map", "shadow") else ())
        if max(wanted, default=-1) >= lights:
            raise ValueError(f"plan: made for another scene, whose light {max(wanted)} this one does not have")


def _split(name: str, lamps: list[Any]) -> tuple[str, int]:
    """The kind of a pass, and the light that it is for."""
    kind, _, last = name.rpartition(" ")
    if not last.isdigit():
        return name, 0
    if int(last) >= len(lamps):
        raise ValueError(f"plan: pass {name!r} is for a light that the scene does not have")
    return kind, int(last)


def _unshadowed(lamp: Any, seen: _Seen, arrays: Any, camera: Any, samples: int, seed: int) -> Floats:
    return light.unshadowed(
        lamp,
        seen.points,
        seen.shading,
        seen.base_color,
        arrays.metallic[seen.material],
        arrays.roughness[seen.material],
        eye=np.asarray(camera.eye, np.float32),
        samples=samples,
        seed=seed,
    )


def _empty_frame(chosen: Plan, background: Floats, lights: int, clock: _Clock) -> Frame:
    width, height = chosen.size
    nothing = np.full((height, width, 3), np.nan, np.float32)
    picture = np.broadcast_to(background, (height, width, 3)).copy()
    clock.done("background")
    return Frame(
        picture,
        np.full((height, width), np.inf, np.float32),
        nothing,
        nothing.copy(),
        np.full((height, width), -1, np.int32),
        tuple(np.ones((height, width), np.float32) for _ in range(lights)),
        clock.times,
        chosen,
    )
