"""The front drawn: error against time, by matplotlib for notebooks, as inline SVG for the page."""

from __future__ import annotations

import html
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .records import Choice, Summary, figure_text, setting_text
from .statistics import Interval

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .results import Study

__all__ = ["COLORS", "cases_svg", "figure", "marker_path", "svg"]

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#7a5195", "#666666")
"""After Okabe and Ito, told apart with every kind of colour vision; markers differ too."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")


@dataclass(frozen=True)
class _Point:
    """A setting in the plane of time and error; `floor` marks an error too small to be seen, drawn at the bottom."""

    summary: Summary
    on_front: bool
    technique: int
    cost: Interval
    error: float
    low: float
    high: float


def _points(study: Study) -> tuple[list[_Point], list[str]]:
    """The points of all settings that can be drawn, and the techniques in order of their appearance."""
    front = {s.setting for s in study.front()}
    able = [s for s in study.summaries() if s.error.known and s.ms.known and s.ms.value > 0]
    techniques = list(dict.fromkeys(r.technique for r in study.records))
    seen = [s.error.value for s in able if s.error.value > 0]
    floor = min(seen, default=1e-3) / 3
    unit = study.cost_unit().per_ms
    return [
        _Point(
            s,
            s.setting in front,
            techniques.index(s.technique),
            Interval(s.ms.value * unit, s.ms.low * unit, s.ms.high * unit),
            max(s.error.value, floor),
            max(s.error.low, floor),
            max(s.error.high, floor),
        )
        for s in able
    ], techniques


def _stairs(points: list[_Point]) -> list[tuple[float, float]]:
    """The line of what one can have: at each time, the least error of the front so far."""
    line: list[tuple[float, float]] = []
    best = math.inf
    for p in sorted((p for p in points if p.on_front), key=lambda p: p.cost.value):
        if p.error < best:
            if line:
                line.append((p.cost.value, best))
            best = p.error
            line.append((p.cost.value, best))
    return line


def _labels(study: Study) -> tuple[str, str]:
    where = f", worst of {len(study.cases)} cases" if len(study.cases) > 1 else ""
    unit = f" ({study.metric['unit']})" if study.metric["unit"] else ""
    return f"{study.cost_unit().long}{where}", f"{study.metric['name']}{unit}{where}"


def figure(study: Study) -> Figure:
    """A matplotlib figure of the front, made without pyplot, so that no state is left behind."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("plot needs matplotlib: pip install 'shadelab[study]'") from error

    class Front(Figure):
        """A figure that shows itself in Jupyter without pyplot."""

        def _repr_png_(self) -> bytes:
            file = io.BytesIO()
            self.savefig(file, format="png", dpi=110)
            return file.getvalue()

    points, techniques = _points(study)
    made = Front(figsize=(8, 5), layout="constrained")
    axes = made.subplots()
    line = _stairs(points)
    axes.plot([x for x, _ in line], [y for _, y in line], color="0.6", linewidth=1, zorder=1)
    for i, technique in enumerate(techniques):
        own = [p for p in points if p.technique == i]
        color, marker = COLORS[i % len(COLORS)], MARKERS[_marker(i)]
        for p in own:
            dim = 1.0 if p.on_front else 0.35
            spans: dict[str, Any] = {
                "xerr": [[p.cost.value - p.cost.low], [p.cost.high - p.cost.value]],
                "yerr": [[p.error - p.low], [p.high - p.error]],
            }
            style: dict[str, Any] = {"fmt": marker, "color": color, "alpha": dim, "markersize": 6, "elinewidth": 0.8}
            axes.errorbar([p.cost.value], [p.error], **spans, **style)
        if own:
            axes.plot([], [], marker, color=color, label=technique)
    if points:
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.legend()
    x, y = _labels(study)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(f"{study.question}: {study.word} against time ({study.mask['name']})", fontsize="medium")
    axes.grid(alpha=0.2, which="both")
    return made


def _svg(width: int, height: int, label: str) -> str:
    size = f'viewBox="0 0 {width} {height}" width="{width}"'
    return f'<svg class="chart" {size} role="img" aria-label="{label}">'


class _Axis:
    """A logarithmic axis between two pixels."""

    def __init__(self, values: list[float], start: float, end: float) -> None:
        low, high = min(values), max(values)
        room = max(math.log10(high / low) * 0.08, 0.08)
        self.low, self.high = math.log10(low) - room, math.log10(high) + room
        self.start, self.end = start, end

    def __call__(self, value: float) -> float:
        t = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start + min(max(t, 0.0), 1.0) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Powers of ten, with 2 and 5 between where there are few, every second or third where there are many."""
        few = self.high - self.low < 2.5
        steps = (1, 2, 5) if few else (1,)
        apart = max(math.ceil((self.high - self.low) * 60 / abs(self.end - self.start)), 1)
        decades = [e for e in range(math.floor(self.low), math.ceil(self.high) + 1) if e % apart == 0]
        return [m * 10.0**e for e in decades for m in steps if self.low <= math.log10(m * 10.0**e) <= self.high]


def svg(study: Study, width: int, height: int, choice: Choice | None = None) -> str:
    """The front as SVG that takes its colours from the page's (light or dark), text in the page's own size."""
    points, _ = _points(study)
    if not points:
        return ""
    left, right, top, bottom = 70, 12, 12, 44
    x = _Axis([v for p in points for v in (p.cost.low, p.cost.high)], left, width - right)
    y = _Axis([v for p in points for v in (p.low, p.high)], height - bottom, top)
    out = [_svg(width, height, f"{study.word} and time")]
    for v in x.ticks():
        out.append(f'<line class="grid" x1="{x(v):.1f}" x2="{x(v):.1f}" y1="{top}" y2="{height - bottom}"/>')
        out.append(f'<text x="{x(v):.1f}" y="{height - bottom + 16}" text-anchor="middle">{v:g}</text>')
    for v in y.ticks():
        out.append(f'<line class="grid" x1="{left}" x2="{width - right}" y1="{y(v):.1f}" y2="{y(v):.1f}"/>')
        out.append(f'<text x="{left - 6}" y="{y(v) + 4:.1f}" text-anchor="end">{v:g}</text>')
    x_label, _ = _labels(study)
    out.append(f'<text x="{(left + width - right) / 2}" y="{height - 8}" text-anchor="middle">{x_label}</text>')
    middle = (top + height - bottom) / 2
    out.append(
        f'<text x="14" y="{middle}" text-anchor="middle" transform="rotate(-90 14 {middle})">{study.word}</text>'
    )
    line = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in _stairs(points))
    out.append(f'<polyline class="front" points="{line}"/>')
    price = study.price()
    for p in sorted(points, key=lambda p: p.on_front):
        out.append(_mark(p, x, y, choice, study.word, price))
    out += _names(points, x, y, width - right)
    out.append("</svg>")
    return "".join(out)


def _names(points: list[_Point], x: _Axis, y: _Axis, end: float) -> list[str]:
    """The knobs of those on the front beside their points, where there is room for them."""
    taken = [(x(p.cost.value) - 7, y(p.error) - 7, x(p.cost.value) + 7, y(p.error) + 7) for p in points]
    out = []
    for p in sorted((p for p in points if p.on_front), key=lambda p: p.error):
        text = ", ".join(figure_text(v) if isinstance(v, float) else str(v) for v in p.summary.knobs.values())
        wide = 6.6 * len(text)
        for dx, dy in ((10, -7), (10, 15), (-10 - wide, 15), (-10 - wide, -7)):
            left, base = x(p.cost.value) + dx, y(p.error) + dy
            box = (left, base - 11, left + wide, base + 2)
            free = all(box[2] < a or box[0] > c or box[3] < b or box[1] > d for a, b, c, d in taken)
            if text and free and x.start < box[0] and box[2] < end and y.end < box[1] and box[3] < y.start:
                taken.append(box)
                out.append(f'<text class="name" x="{left:.1f}" y="{base:.1f}">{html.escape(text)}</text>')
                break
    return out


def _mark(p: _Point, x: _Axis, y: _Axis, choice: Choice | None, word: str, unit: tuple[str, float]) -> str:
    """A point with its intervals, a shape for its technique, and a title that a pointer shows."""
    color = COLORS[p.technique % len(COLORS)]
    s, px, py = p.summary, x(p.cost.value), y(p.error)
    title = f"{s.setting}: {word} {figure_text(s.error.value)}, {figure_text(s.ms.value * unit[1])} {unit[0]}"
    bars = (
        f'<path d="M{x(p.cost.low):.1f} {py:.1f}H{x(p.cost.high):.1f}M{px:.1f} {y(p.low):.1f}V{y(p.high):.1f}" '
        f'stroke="{color}" fill="none"/>'
    )
    ring = ""
    if choice is not None and choice.setting == s.setting:
        ring = f'<circle cx="{px:.1f}" cy="{py:.1f}" r="11" fill="none" stroke="currentColor" stroke-width="2"/>'
    shape = marker_path(p.technique, px, py)
    dim = "" if p.on_front else ' opacity="0.35"'
    return f'<g{dim}><title>{html.escape(title)}</title>{bars}<path d="{shape}" fill="{color}"/>{ring}</g>'


def cases_svg(study: Study, settings: Sequence[tuple[str, dict[str, Any]]], width: int) -> str:
    """The error of each setting, case by case, a line for each case: where a technique holds, and where it breaks."""
    techniques = list(dict.fromkeys(r.technique for r in study.records))
    names = {setting_text(*s): techniques.index(s[0]) for s in settings}
    first = {i: name for name, i in reversed(names.items())}
    found = {(r.case, r.setting): r for r in study.records if r.setting in names and r.error.known}
    seen = [r.error.value for r in found.values() if r.error.value > 0]
    if not seen:
        return ""
    # Errors too small to be seen stand at the left end.
    floor = min(seen) / 3
    wide, left, top, step = width > 600, 12, 12, 26
    left += 7 * max(len(c.name) for c in study.cases) if wide else 0
    step = step if wide else 40
    height = top + step * len(study.cases) + 34
    x = _Axis([floor, *seen], left, width - 12)
    out = [_svg(width, height, f"{study.word} by case")]
    for v in x.ticks():
        out.append(f'<line class="grid" x1="{x(v):.1f}" x2="{x(v):.1f}" y1="{top}" y2="{height - 34}"/>')
        out.append(f'<text x="{x(v):.1f}" y="{height - 16}" text-anchor="middle">{v:g}</text>')
    for row, case in enumerate(study.cases):
        y = top + step * (row + (0.5 if wide else 0.75))
        at = f'x="{left - 8}" y="{y + 4:.1f}" text-anchor="end"' if wide else f'x="{left}" y="{y - 14:.1f}"'
        out.append(f"<text {at}>{html.escape(case.name)}</text>")
        out.append(f'<line class="grid" x1="{left}" x2="{width - 12}" y1="{y:.1f}" y2="{y:.1f}"/>')
        for name, i in names.items():
            if (record := found.get((case.key, name))) is not None:
                e, color = record.error, COLORS[i % len(COLORS)]
                low, high = (x(max(v, floor)) for v in (e.low, e.high))
                fill = f'fill="{color}"' if first[i] == name else 'fill="none" stroke-width="1.5"'
                title = f"{name}, {case.name}: {study.word} {figure_text(e.value)}"
                out.append(
                    f'<g opacity="0.85"><title>{html.escape(title)}</title>'
                    f'<path d="M{low:.1f} {y:.1f}H{high:.1f}" stroke="{color}" fill="none"/>'
                    f'<path d="{marker_path(i, x(max(e.value, floor)), y)}" stroke="{color}" {fill}/></g>'
                )
    out.append("</svg>")
    return "".join(out)


def _marker(technique: int) -> int:
    """Which marker a technique has: another where colours come round."""
    return (technique + technique // len(COLORS)) % len(MARKERS)


def marker_path(technique: int, x: float, y: float, r: float = 5.5) -> str:
    """The outline of a technique's marker."""
    kind = _marker(technique)
    if kind == 0:
        return f"M{x - r:.1f} {y:.1f}a{r} {r} 0 1 0 {2 * r} 0a{r} {r} 0 1 0 {-2 * r} 0z"
    sides, turn = ((4, 45), (3, -90), (4, 0), (3, 90), (6, 0), (5, -90), (8, 0))[kind - 1]
    corners = [
        (x + 1.2 * r * math.cos(math.radians(turn + 360 * i / sides)),
         y + 1.2 * r * math.sin(math.radians(turn + 360 * i / sides)))
        for i in range(sides)
    ]  # fmt: skip
    return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in corners) + "z"
