"""The table of a study, as text and as HTML."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .records import Record, Summary, figure_text, setting_text

if TYPE_CHECKING:
    from .results import Study

__all__ = ["STYLE", "case_text", "cases_table", "counter_text", "html_table", "text_table"]


def counter_text(value: float) -> str:
    """A counter: whole where it is whole, large ones by thousands."""
    for scale, unit in ((1e9, " G"), (1e6, " M"), (1e4, " k")):
        if abs(value) >= scale:
            return f"{value / (scale if scale != 1e4 else 1e3):.3g}{unit}"
    return f"{value:.4g}"


def _columns(study: Study) -> tuple[list[str], list[str]]:
    """Names of the figures beside and of the counters, in the order of their appearance."""
    also = list(dict.fromkeys(k for r in study.records for k in r.also))
    counters = list(dict.fromkeys(k for r in study.records for k in r.counters))
    return also, counters


def _rows(study: Study, part: str = "") -> tuple[list[str], list[tuple[Summary, bool, list[str]]]]:
    """Heads and cells of every setting, cheapest first, with whether it is on the front.

    `part` is "cost" or "cause" for half of the columns (a page is narrow), or empty for all.
    """
    also, counters = _columns(study)
    front = {s.setting for s in study.front()}
    many = len(study.cases) > 1
    unit, timed = study.cost_unit(), study.settings.get("cost", "time") == "time"
    heads = _chosen(
        part,
        [study.word, "95 %"],
        ["worst in"] if many else [],
        ["least"] if many else [],
        ["bias", "noise", "precision", "whole frame"],
        also,
        [unit.short, "± MAD", "prepare"] if timed else [unit.short],
        counters,
    )
    rows = []
    for s in study.summaries():
        cells = _chosen(
            part,
            [
                figure_text(s.error.value) + ("" if not s.strays else f" ({s.strays} not finite)"),
                f"{figure_text(s.error.low)} … {figure_text(s.error.high)}",
            ],
            [s.error_case if s.complete else f"{s.error_case} (alone)"] if many else [],
            [figure_text(s.best_error)] if many else [],
            [figure_text(v) for v in (s.bias, s.noise, s.precision, s.frame_error)],
            [figure_text(s.also.get(k)) for k in also],
            [figure_text(v * unit.per_ms) for v in ((s.ms.value, s.spread, s.prepare_ms) if timed else (s.ms.value,))],
            [counter_text(s.counters[k]) if k in s.counters else "–" for k in counters],
        )
        rows.append((s, s.setting in front, [s.setting, *cells]))
    return ["setting", *heads], rows


def _chosen(
    part: str,
    error: list[str],
    where: list[str],
    least: list[str],
    causes: list[str],
    also: list[str],
    times: list[str],
    counters: list[str],
) -> list[str]:
    """The columns of one part of the table, or all."""
    if part == "cost":
        return [error[0], times[0], error[1], *where, *times[1:], *counters]
    if part == "cause":
        return [error[0], *least, *causes, *also]
    return [*error, *least, *where, *causes, *also, *times, *counters]


def _legend(study: Study) -> list[str]:
    m = study.machine
    worst = f"worst of {len(study.cases)} cases" if len(study.cases) > 1 else study.cases[0].name if study.cases else ""
    unit = f" ({study.metric['unit']})" if study.metric["unit"] else ""
    price = study.cost_unit()
    if study.settings.get("cost", "time") != "time":
        return [
            f"{study.word}: {study.metric['name']}{unit}, over: {study.mask['name']}; {worst}",
            f"{price.short}: {price.long}; ms: median, preparation included, on {m['threads']} threads of {m['cpu']}",
        ]
    return [
        f"{study.word}: {study.metric['name']}{unit}, over: {study.mask['name']}; {worst}",
        f"{price.short}: median, preparation included, on {m['threads']} threads of {m['cpu']} "
        f"({m['simd']}); ranks may differ on a GPU",
    ]


def text_table(study: Study) -> str:
    """The table as text: one setting a line, cheapest first, a star on those of the front."""
    heads, rows = _rows(study)
    lines = [heads, *(cells for _, _, cells in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]
    left = {0, heads.index("worst in") if "worst in" in heads else 0}

    def row(cells: list[str], mark: str) -> str:
        aligned = [c.ljust(w) if i in left else c.rjust(w) for i, (c, w) in enumerate(zip(cells, widths, strict=True))]
        return f"{mark} {'  '.join(aligned)}".rstrip()

    head = row(heads, " ")
    title = f"{study.question}: {len(rows)} settings, {sum(on for _, on, _ in rows)} on the front (*)"
    body = [row(cells, "*" if on else " ") for _, on, cells in rows]
    return "\n".join([title, head, "-" * len(head), *body, *_legend(study)])


def cases_table(study: Study, settings: Sequence[tuple[str, dict[str, Any]]]) -> list[tuple[str, list[list[str]]]]:
    """Each figure's title, and its table: a row of settings, then a row for each case with its name before."""
    found = {(r.case, r.setting): r for r in study.records}
    names = [setting_text(*s) for s in settings]
    also, _ = _columns(study)
    unit = study.cost_unit()
    tables = []
    for title in [study.word, *also, unit.short]:
        rows = [["", *names]]
        for case in study.cases:
            records = [found.get((case.key, name)) for name in names]
            rows.append([case.name, *(_figure(r, title, study.word, also, unit.per_ms) for r in records)])
        tables.append((title, rows))
    return tables


def _figure(record: Record | None, title: str, word: str, also: list[str], per_ms: float) -> str:
    if record is None:
        return "–"
    if title in also:
        return figure_text(record.also.get(title))
    return figure_text(record.error.value if title == word else record.ms.value * per_ms)


def case_text(study: Study) -> str:
    """`cases_table` as text."""
    out = []
    for title, rows in cases_table(study, study.few()):
        rows[0][0] = title
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        lines = [
            "  ".join(
                c.rjust(w) if i else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
            for row in rows
        ]
        out.append("\n".join([lines[0], "-" * len(lines[0]), *lines[1:]]))
    return "\n\n".join(out)


STYLE = """
.shadelab-table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.9em}
.shadelab-table th,.shadelab-table td{padding:.25em .6em;text-align:right;white-space:nowrap}
.shadelab-table th,.shadelab-table td{border-bottom:1px solid #8884}
.shadelab-table th:first-child,.shadelab-table td:first-child,.shadelab-table .text{text-align:left}
.shadelab-table .front td:first-child{font-weight:600}
.shadelab-table .choice td{background:#2a9d4a33}
"""


def html_table(study: Study, choice: tuple[str, dict[str, Any]] | None = None, part: str = "") -> str:
    """The table as HTML, settings of the front in bold and starred, the choice marked."""
    heads, rows = _rows(study, part)
    chosen = setting_text(*choice) if choice else None
    worst = heads.index("worst in") if "worst in" in heads else -1

    def cell(tag: str, i: int, text: str) -> str:
        kind = ' class="text"' if i == worst else ""
        return f"<{tag}{kind}>{html.escape(text)}</{tag}>"

    out = [f"<style>{STYLE}</style>", '<div style="overflow-x:auto"><table class="shadelab-table"><thead><tr>']
    out += [cell("th", i, h) for i, h in enumerate(heads)]
    out.append("</tr></thead><tbody>")
    for s, on, cells in rows:
        kinds = [k for k, is_so in (("front", on), ("choice", s.setting == chosen)) if is_so]
        out.append(f'<tr class="{" ".join(kinds)}">' if kinds else "<tr>")
        out.append(cell("td", 0, ("★\u00a0" if on else "") + cells[0]))
        out += [cell("td", i + 1, c) for i, c in enumerate(cells[1:])]
        out.append("</tr>")
    out.append("</tbody></table></div>")
    if not part:
        out += [f"<p>{html.escape(line)}</p>" for line in _legend(study)]
    return "".join(out)
