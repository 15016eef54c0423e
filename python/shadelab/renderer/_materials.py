"""Which model and which method shade each material: the cheapest whose error, measured on the scene, keeps a bound."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .. import brdf, light
from .._arrays import Floats
from ..scene import Material
from ._buffers import Seen, g_buffer
from .passes import Shading
from .shading import shade

# Where errors are measured: the surfaces that a small picture shows, so many of each material at most.
_LOOK = (96, 54)
_PLACES = 128
# Samples of either half of the reference.
_REFERENCE = 512
# What is not asked for otherwise.
DEFAULT_ERROR = 0.02

# Nanoseconds a surface on one thread, as measured (AVX2, 2.5 GHz, a busy machine): of one punctual light, of an area
# light by closed forms, and of each sample of one. They rank; times on other machines differ, ratios hardly.
_BEAM = {"diffuse": 5.0, "metallic roughness": 7.0}
_BEAM_OTHER = 45.0
_CLOSED = {"point": 100.0, "diffuse": 680.0, "representative_point": 850.0, "ltc": 1400.0}
_SAMPLE = {"metallic roughness": 280.0, "specular glossiness": 280.0}
_SAMPLE_OTHER = 350.0


PUNCTUAL = light.PointLight | light.SpotLight | light.DirectionalLight


class Candidate(NamedTuple):
    """A way to shade a material."""

    model: Any
    name: str
    """Of the model."""
    method: str
    samples: int

    def cost(self, beams: int, areas: int) -> float:
        """Nanoseconds a surface."""
        sum_ = beams * _BEAM.get(self.name, _BEAM_OTHER)
        if self.name == "diffuse":
            return sum_ + areas * min(_CLOSED["diffuse"], _CLOSED.get(self.method, 1e9))
        if self.method == "sampling":
            closed = _CLOSED["diffuse"] if self.name in _SAMPLE else 0.0
            return sum_ + areas * (closed + self.samples * _SAMPLE.get(self.name, _SAMPLE_OTHER))
        return sum_ + areas * _CLOSED[self.method]


def _named(model: Any) -> str:
    """A model's name in words."""
    name = "MetallicRoughness" if isinstance(model, Material) else type(model).__name__
    words = "".join(" " + c.lower() if c.isupper() else c for c in name).strip()
    compensated = getattr(model, "compensation", "none") != "none"
    return words + " with compensation" if compensated else words


def _models(material: Any) -> list[tuple[Any, str]]:
    """A material's models, the simpler before itself."""
    model = material._model() if isinstance(material, Material) else material
    found: list[tuple[Any, str]] = []
    if not model._transmits and not isinstance(model, brdf.Conductor):
        stand_in = model._stand_in()
        if stand_in.metallic < 1:
            albedo = tuple(c * (1 - stand_in.metallic) for c in stand_in.base_color)
            found.append((brdf.Diffuse(albedo), "diffuse"))
        found.append((stand_in, "metallic roughness"))
        if getattr(model, "compensation", "none") != "none":
            plain = replace(model, compensation="none")
            if plain != stand_in:
                found.append((plain, _named(plain)))
    elif getattr(model, "compensation", "none") != "none":
        plain = replace(model, compensation="none")
        found.append((plain, _named(plain)))
    name = _named(model)
    if name == "diffuse":
        return [(model, name)]
    return [x for x in found if x[1] != name] + [(model, name)]


def candidates(material: Any, beams: int, areas: int, even: int) -> list[Candidate]:
    """What may shade a material under so many punctual and area lights, the cheapest first; of these `even` ambient."""
    found = []
    for model, name in _models(material):
        lobed = name in ("diffuse", "metallic roughness", "specular glossiness")
        ways: list[tuple[str, int]] = []
        if areas == 0:
            ways = [("sampling", 0)]
        else:
            smooth = isinstance(model, brdf.Conductor)
            if areas > even and not smooth and not isinstance(model, brdf.Dielectric):
                ways.append(("point", 16))
            if name == "diffuse":
                ways.append(("sampling", 0))
            elif lobed and areas > even:
                ways += [("representative_point", 16), ("ltc", 16)]
            if name != "diffuse":
                ways += [("sampling", n) for n in ((1,) if smooth else (4, 16, 64, 256))]
        found += [Candidate(model, name, *way) for way in ways]
    return sorted(found, key=lambda c: c.cost(beams, areas))


class _Places(NamedTuple):
    """Receivers of one material."""

    seen: Seen
    at: Any
    eye: Floats
    lamps: list[Any]

    def shade(self, model: Any, method: str, samples: int, seed: int, lamps: list[Any] | None = None) -> Floats:
        seen, at = self.seen, self.at
        return shade(
            seen.points[at],
            seen.shading[at],
            model,
            self.lamps if lamps is None else lamps,
            eye=self.eye,
            colors=None if seen.colors is None else seen.colors[at],
            geometric_normals=seen.geometric[at],
            inside=seen.inside[at],
            method=method,
            samples=samples,
            seed=seed,
        ).astype(np.float64)


def places(arrays: Any, camera: Any, lamps: list[Any]) -> list[_Places]:
    """Where each material is seen."""
    seen = g_buffer(arrays, camera, _LOOK)
    eye = np.asarray(camera.eye, np.float32)
    found = []
    for row in range(len(arrays.materials)):
        at = np.flatnonzero(seen.material == row)
        found.append(_Places(seen, at[:: max(1, -(-len(at) // _PLACES))], eye, lamps))
    return found


def _measured(where: _Places, ways: list[Candidate], material: Any, bound: float) -> list[tuple[Candidate, float]]:
    """Candidates with their errors, until one keeps the bound."""
    areas = [x for x in where.lamps if not isinstance(x, PUNCTUAL)]
    first, second = (where.shade(material, "sampling", _REFERENCE if areas else 0, seed) for seed in (101, 202))
    scale = max(float((first + second).mean()) / 2, 1e-300)
    found = []
    for way in ways:
        value = where.shade(way.model, way.method, way.samples, 303)
        # Two independent halves take the reference's own noise out of the square.
        square = float(np.mean((value - first) * (value - second)))
        found.append((way, max(square, 0.0) ** 0.5 / scale))
        if found[-1][1] <= bound:
            break
    return found


def shadings(
    arrays: Any, where: list[_Places], max_error: float | None, budget_ms: float | None, pixels: int
) -> tuple[Shading, ...]:
    """How each material of a scene is shaded."""
    lamps = where[0].lamps if where else []
    areas = sum(not isinstance(x, PUNCTUAL) for x in lamps)
    ambient = sum(isinstance(x, light.AmbientLight) for x in lamps)
    beams = len(lamps) - areas
    bound = DEFAULT_ERROR if max_error is None else max_error
    least = -1.0 if budget_ms is not None else bound
    tried: list[list[tuple[Candidate, float]]] = []
    for material, spot in zip(arrays.materials, where, strict=True):
        ways = candidates(material, beams, areas, ambient)
        tried.append(_measured(spot, ways, material, least) if len(spot.at) else [])
    share = [len(np.flatnonzero(spot.seen.material == row)) for row, spot in enumerate(where)]
    covered = pixels * sum(share) / (_LOOK[0] * _LOOK[1])
    weights = [covered * s / max(sum(share), 1) for s in share]

    def chosen(limit: float) -> list[tuple[Candidate, float] | None]:
        return [
            next((x for x in found if x[1] <= limit), min(found, key=lambda x: x[1])) if found else None
            for found in tried
        ]

    def milliseconds(picks: list[tuple[Candidate, float] | None]) -> float:
        return sum(w * x[0].cost(beams, areas) * 1e-6 for w, x in zip(weights, picks, strict=True) if x is not None)

    if budget_ms is not None:
        limits = sorted({error for found in tried for _, error in found if max_error is None or error <= max_error})
        limits = limits or [bound]
        bound = next((x for x in limits if milliseconds(chosen(x)) <= budget_ms), limits[-1])
    picks = chosen(bound)
    told = [
        _told(material, pick, found, bound, beams, areas)
        for material, pick, found in zip(arrays.materials, picks, tried, strict=True)
    ]
    if areas > 1:
        told = [
            told_ if pick is None else _by_light(told_, pick, spot, material, bound)
            for told_, pick, spot, material in zip(told, picks, where, arrays.materials, strict=True)
        ]
    return tuple(told)


def _by_light(told: Shading, pick: tuple[Candidate, float], where: _Places, material: Any, bound: float) -> Shading:
    """A material's choice with the cheapest method for each light, where that is cheaper and keeps the bound."""
    way, error = pick
    if error > bound:
        return told
    lamps, areas = where.lamps, [not isinstance(x, PUNCTUAL) for x in where.lamps]
    # Biases may add up: each light has its part of the bound.
    part = bound / sum(areas)
    halves = [[where.shade(material, "sampling", _REFERENCE, s, [x]) for x in lamps] for s in (101, 202)]
    scale = max(float(np.sum(halves) / 2 / halves[0][0].size), 1e-300)

    def off(value: Any, first: Any, second: Any) -> float:
        return max(float(np.mean((value - first) * (value - second))), 0.0) ** 0.5 / scale

    chosen: list[tuple[str, int]] = []
    total: Any = 0.0
    for i, lamp in enumerate(lamps):
        picked, value = way, None
        even = int(isinstance(lamp, light.AmbientLight))
        for other in candidates(way.model, 0, 1, even) if areas[i] else ():
            # The models before it do not suffice for all lights together.
            if other.name != way.name or other.cost(0, 1) >= way.cost(0, 1):
                continue
            value = where.shade(other.model, other.method, other.samples, 303, [lamp])
            if off(value, halves[0][i], halves[1][i]) <= part:
                picked = other
                break
            value = None
        if value is None:
            value = where.shade(way.model, way.method, way.samples, 303, [lamp])
        chosen.append((picked.method, picked.samples) if areas[i] else (way.method, way.samples))
        total = total + value
    apart = off(total, np.sum(halves[0], 0), np.sum(halves[1], 0))
    if len({c for c, area in zip(chosen, areas, strict=True) if area}) < 2 or apart > bound:
        return told
    reason = told.reason + ("; " if told.reason else "") + "the cheapest for each light"
    return replace(told, error=apart, reason=reason, by_light=tuple(chosen))


def _told(
    material: Any,
    pick: tuple[Candidate, float] | None,
    found: list[tuple[Candidate, float]],
    bound: float,
    beams: int,
    areas: int,
) -> Shading:
    """A choice in words."""
    own = _named(material)
    label = getattr(material, "name", "") or own
    if pick is None:
        return Shading(label, material, own, "sampling", 16, float("nan"), "out of view: not measured")
    way, error = pick
    reasons = []
    layers = [words for name, words in _LAYERS.items() if getattr(material, name, 0) > 0]
    if way.name != own:
        reasons.append(f"{own} is not needed" + (f", nor its {' and '.join(layers)}" if layers else ""))
    elif layers:
        reasons.append(f"with its {' and '.join(layers)}: no simpler model has that")
    if areas:
        reasons.append(_WHY.get(way.method, "") if way.name != "diffuse" or way.method == "point" else _WHY["closed"])
    elif beams:
        reasons.append("punctual lights alone: exact")
    worse = [x for x in found if x[1] > bound and x[0].cost(beams, areas) < way.cost(beams, areas)]
    if worse:
        nearest = min(worse, key=lambda x: x[1])
        name = nearest[0].name if nearest[0].name != way.name else nearest[0].method.replace("_", " ")
        if nearest[0].method == "sampling" and nearest[0].samples:
            name += f" of {nearest[0].samples} samples"
        reasons.append(f"the best that is cheaper, {name}, is off by {nearest[1]:.1%}")
    return Shading(label, way.model, way.name, way.method, way.samples, error, "; ".join(r for r in reasons if r))


_LAYERS = {"sheen": "sheen", "clearcoat": "clear coat"}
_WHY = {
    "point": "lights small or far enough to be points",
    "representative_point": "one point of each area light stands for it",
    "ltc": "an area light meets a glossy surface: transformed cosines",
    "sampling": "an area light meets a glossy surface: samples",
    "closed": "the diffuse part of area lights in closed form",
}


def reflectances(arrays: Any, where: list[_Places], background: Any) -> tuple[tuple[Any, ...], float]:
    """What each material reflects of even light on the average over where it is seen, and the largest error of that.

    The error is over the mean radiance of the material with all its light.
    """
    white, found, worst = [light.AmbientLight((1.0, 1.0, 1.0))], [], 0.0
    for row, (material, spot) in enumerate(zip(arrays.materials, where, strict=True)):
        if not len(spot.at):
            found.append(tuple(arrays.base_color[row].tolist()))
            continue
        halves = [spot.shade(material, "sampling", 64, seed, white) for seed in (101, 202)]
        colors = 1.0 if spot.seen.colors is None else spot.seen.colors[spot.at].astype(np.float64)
        mean = (
            (halves[0] + halves[1]).mean(0) / 2 / np.maximum(np.mean(np.broadcast_to(colors, halves[0].shape), 0), 1e-9)
        )
        apart = [(mean * colors - half) * np.asarray(background) for half in halves]
        total = (halves[0] * np.asarray(background)).mean()
        if spot.lamps:
            total += spot.shade(material, "sampling", 16, 303).mean()
        worst = max(worst, max(float(np.mean(apart[0] * apart[1])), 0.0) ** 0.5 / max(float(total), 1e-300))
        found.append(tuple(mean.tolist()))
    return tuple(found), worst
