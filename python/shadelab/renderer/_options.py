"""What may find the shadow of a light, and the choice among it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from .. import light
from ._trials import OfLight, extended, milliseconds

# The error of shadows that is not asked for otherwise: a tenth of the light, where they have edges.
USUAL = 0.1
# The fewest rays that are taken if no bound asks for fewer, and the most.
_USUAL_RAYS, _RAYS = 16, 4096
# Penumbrae are of one width if a tenth is at most so many times narrower than a tenth is wide.
_ALIKE = 3.0
# Texels that pages reach beyond receivers where penumbrae are searched and filtered.
_BESIDE = 64

_BILINEAR = {"technique": "pcf", "samples": 4, "radius": 1.0, "kernel": "grid", "bilinear": True, "seed": None}


class Option(NamedTuple):
    """One way to find a shadow: the map's settings, None for rays; the technique's; and its price."""

    chart: Mapping[str, Any] | None
    how: Mapping[str, Any]
    ms: float

    @property
    def name(self) -> str:
        """In a few words."""
        knobs = self.how
        counts = [str(knobs[k]) for k in ("blocker_samples", "filter_samples", "samples") if k in knobs]
        name = knobs["technique"] + (f" of {'+'.join(counts)}" if counts else "")
        if "filter" in knobs:
            name += f" by {knobs['filter']}"
        if self.chart is None:
            return name
        kind = self.chart.get("kind", "cascades" if "cascades" in self.chart else "")
        return f"{name} in {kind + ' ' if kind else ''}{self.chart['resolution']}²"


class Choice(NamedTuple):
    """The option taken, and what is known of it."""

    option: Option
    error: float
    told: str
    """The expected error, the price, and which bounds are not kept."""


Price = Callable[[Mapping[str, Any] | None, Mapping[str, Any]], float]


def priced(pairs: Iterable[tuple[Mapping[str, Any] | None, Mapping[str, Any]]], price: Price) -> list[Option]:
    """Options by their price, the cheapest first."""
    return sorted((Option(chart, how, price(chart, how)) for chart, how in pairs), key=lambda o: o.ms)


def of_rays(least: int, most: int = _RAYS) -> list[tuple[None, Mapping[str, Any]]]:
    """Rays, twice as many each time."""
    counts = [2**k for k in range(13) if least <= 2**k <= most]
    return [(None, {"technique": "ray_traced", "samples": n}) for n in counts]


def sharp(charts: Iterable[Mapping[str, Any]], bounded: bool, most_rays: int) -> list[tuple[Any, Mapping[str, Any]]]:
    """For lights without penumbrae: one comparison; where bounds are asked for, four between texels, or rays."""
    found: list[tuple[Any, Mapping[str, Any]]] = []
    for chart in charts:
        found.append((chart, {"technique": "hard"}))
        if bounded:
            found.append((chart, _BILINEAR))
    return found + of_rays(1, most_rays) if bounded else found


def soft(
    charts: Iterable[Mapping[str, Any]],
    where: OfLight,
    width: tuple[float, float, float, float] | None,
    least_rays: int,
) -> list[tuple[Any, Mapping[str, Any]]]:
    """For lights with an extent: one comparison, filters of one width where penumbrae are alike, of their own, rays."""
    found: list[tuple[Any, Mapping[str, Any]]] = []
    for chart in charts:
        kind = chart.get("kind", "single")
        if kind == "single":
            found.append((chart, {"technique": "hard"}))
        if kind == "single" and width is not None and width[1] <= _ALIKE * width[0]:
            found += [(chart, how) for how in _of_one_width(where.chart(chart), width[3])]
        found += [
            (chart, {"technique": "pcss", "blocker_samples": n, "filter_samples": 2 * n}) for n in (8, 16, 32, 64)
        ]
        if kind == "single":
            # As many texels as wide boxes of them need.
            ways = (("mip", max(chart["resolution"] // 512, 1)), ("summed_area", max(chart["resolution"] // 256, 2)))
            found += [(chart, {"technique": "variance_soft", "filter": f, "reduce": r}) for f, r in ways]
    return found + of_rays(least_rays)


def _of_one_width(chart: Any, width: float) -> list[Mapping[str, Any]]:
    """Filters as wide as a penumbra in the world: by comparisons, or of moments beforehand."""
    depth = (chart.near + chart.far) / 2.0
    # A Gaussian's deviation is that of a box as wide.
    sigma = width / 12.0**0.5 / max(chart.texel_size(depth), 1e-300)
    found: list[Mapping[str, Any]] = [
        {"technique": "pcf", "samples": n, "radius": width / 2.0, "units": "world", "kernel": "box"} for n in (16, 64)
    ]
    if 1.0 <= sigma <= 64.0:
        found.append({"technique": "moment", "sigma": round(sigma, 1), "reduce": 4 if sigma > 8.0 else 2})
    return found


def virtual(resolution: int, soft_: bool) -> Mapping[str, Any]:
    """A map of which the pages are drawn that a view looks into."""
    return {"kind": "virtual", "resolution": resolution, **({"border": _BESIDE} if soft_ else {})}


def least_rays(bounds: Mapping[str, float], usual: int = _USUAL_RAYS) -> int:
    """The fewest rays towards a light with an extent that are considered."""
    return 1 if bounds else usual


def chosen(options: list[Option], where: OfLight, bounds: Mapping[str, float]) -> Choice:
    """The cheapest option that keeps the error asked for; the least error that a budget allows; both if both are."""
    bound, budget = bounds.get("max_error"), bounds.get("budget_ms")
    within = options if budget is None else [o for o in options if o.ms <= budget] or options[:1]
    limit = (USUAL if budget is None else -1.0) if bound is None else bound
    tried: list[tuple[Option, float]] = []
    for option in within:
        tried.append((option, where.expected(option.chart, option.how)))
        if tried[-1][1] <= limit:
            break
    taken, error = tried[-1] if tried[-1][1] <= limit else min(tried, key=lambda x: x[1])
    return Choice(taken, error, _told(taken, error, tried, where, bounds))


def _told(
    taken: Option, error: float, tried: list[tuple[Option, float]], where: OfLight, bounds: Mapping[str, float]
) -> str:
    bound, budget = bounds.get("max_error"), bounds.get("budget_ms")
    if not len(where.at):
        said = "nothing in view faces the light"
    elif taken.chart is None and not extended(where.lamp):
        said = "one ray is exact for a light without extent"
    else:
        said = f"expected error {error:.2g} " + (
            "at the shadow's edges" if where.edges else "with no shadow's edge in view"
        )
    said += f"; about {taken.ms:.2g} ms"
    cheaper = [x for x in tried if x[0].ms < taken.ms]
    if cheaper and taken.ms > 0.0:
        best = min(cheaper, key=lambda x: x[1])
        said += f"; the best that is cheaper, {best[0].name}, is off by {best[1]:.2g}"
    if bound is not None and error > bound:
        said += f"; max_error {bound:g} is not kept"
    if budget is not None and taken.ms > budget:
        said += f"; budget_ms {budget:.3g} is not kept"
    return said


def price_of(lamp: Any, receivers: float, faces: int, built: bool) -> Price:
    """What anything costs in a picture."""
    parallel = isinstance(lamp, light.DirectionalLight)
    return lambda chart, how: milliseconds(chart, how, receivers, faces, built, parallel)
