"""The page of a report: one HTML file without a single address outside itself."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from . import chart
from .chart import COLORS, marker_path
from .records import Choice, figure_text
from .statistics import Interval
from .tables import cases_table, html_table

if TYPE_CHECKING:
    from .report import CaseStrip
    from .results import Study

__all__ = ["html_page"]

_STYLE = """
:root{color-scheme:light dark;--ink:#1b1f24;--paper:#fff;--soft:#5a6470;--line:#8883;--box:#f3f5f7;--good:#2a9d4a}
@media (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--paper:#14171a;--soft:#a3adb8;--box:#1f2429;--good:#5fd07f}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",sans-serif}
main{max-width:1120px;margin:0 auto;padding:1rem clamp(.8rem,3vw,2rem) 4rem}
h1{font-size:clamp(1.5rem,5vw,2.2rem);line-height:1.2;margin:.5em 0 .2em}
h2{margin:2.2em 0 .6em;border-bottom:1px solid var(--line);padding-bottom:.2em}
h3{margin:1.8em 0 .4em}
p{max-width:72ch}
.soft,figcaption,small{color:var(--soft)}
.choice-box{background:var(--box);border-left:4px solid var(--good);padding:.7em 1em;margin:1em 0;max-width:80ch}
.choice-box.none{border-color:#d55e00}
.choice-box b{font-size:1.15em}
nav a{margin-right:1em}
a{color:inherit}
.chart{max-width:100%;height:auto;font-size:13px}
.chart text{fill:var(--ink)}
.chart .name{font-size:11px;fill:var(--soft)}
.chart .grid{stroke:var(--line)}
.chart .front{fill:none;stroke:var(--soft);stroke-width:1.5}
.narrow{display:none}
.legend{display:flex;flex-wrap:wrap;gap:.3em 1.2em;font-size:.9em}
.legend svg{width:14px;height:14px;vertical-align:-2px;margin-right:.3em}
.scroll{overflow-x:auto}
.strip{display:grid;grid-template-columns:repeat(3,1fr);gap:.6rem;margin:0 0 .9rem}
figure{margin:0;break-inside:avoid}
figure img{width:100%;height:auto;display:block;border-radius:3px}
figcaption{font-size:.85em;overflow-wrap:anywhere}
.scale{display:inline-block;width:9em;height:.8em;vertical-align:-1px;border-radius:2px;
background:linear-gradient(90deg,#053061,#4393c3,#f7f7f7,#d6604d,#67001f)}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.2em 1.2em}
dt{font-weight:600}
dd{margin:0;overflow-wrap:anywhere;max-width:80ch}
table.plain{border-collapse:collapse;font-size:.9em}
table.plain th,table.plain td{padding:.25em .7em .25em 0;text-align:left;border-bottom:1px solid var(--line)}
pre{overflow-x:auto;background:var(--box);padding:.8em;font-size:.85em}
main .shadelab-table td:first-child{white-space:normal;min-width:12em;max-width:22em;overflow-wrap:anywhere}
main .cases th{vertical-align:bottom;white-space:normal;line-height:1.25}
main .cases th,main .cases td{padding:.25em .45em}
@media screen and (max-width:720px){
.wide{display:none}.narrow{display:block}
.strip{grid-template-columns:1fr 1fr}
.strip figure:first-child{grid-column:1/-1}
dl{grid-template-columns:1fr}dd{margin:0 0 .6em}
main .shadelab-table th:first-child,main .shadelab-table td:first-child{position:sticky;left:0;background:var(--paper)}
main .shadelab-table td:first-child{min-width:9.5em;max-width:44vw;font-size:.82em}
}
@media print{
@page{margin:12mm}
:root{--ink:#000;--paper:#fff;--soft:#444;--box:#f3f5f7}
body{font-size:10pt}main{max-width:none;padding:0}nav{display:none}
h2,h3{break-after:avoid}.strip,tr,.choice-box,.chart{break-inside:avoid}
main .shadelab-table{font-size:6.6pt}
main .shadelab-table th,main .shadelab-table td{padding:.15em .35em}
.scroll,.scroll div{overflow:visible!important}
*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
}
"""


def html_page(study: Study, strips: list[CaseStrip], choice: Choice | None, refusal: str) -> str:
    """The whole page."""
    title = f"{study.question}: what each technique costs and what it loses"
    parts = [
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width,initial-scale=1">',
        f"<title>{_text(title)}</title><style>{_STYLE}</style></head><body><main>",
        f"<h1>{_text(title)}</h1>",
        f"<p>{_text(study.about)}</p>",
        _choice_box(choice, refusal),
        '<nav><a href="#front">Front</a><a href="#figures">Figures</a>',
        '<a href="#cases">Case by case</a>' if len(study.cases) > 1 else "",
        '<a href="#pictures">Pictures</a>' if strips else "",
        '<a href="#measured">How it was measured</a><a href="#machine">Machine</a></nav>',
        _front(study, choice),
        _figures(study, choice),
        _cases(study, choice),
        _pictures(study, strips),
        _plans(study),
        _measured(study),
        _machine(study),
        _glossary(study),
        "</main></body></html>\n",
    ]
    return "".join(parts)


def _text(text: object) -> str:
    return html.escape(str(text))


def _interval(unit: tuple[str, float], t: Interval) -> str:
    low, middle, high = (figure_text(v * unit[1]) for v in (t.low, t.value, t.high))
    return f"{middle} {unit[0]} ({low} … {high})" if t.low < t.high else f"{middle} {unit[0]}"


def _choice_box(choice: Choice | None, refusal: str) -> str:
    if refusal:
        return f'<p class="choice-box none">{_text(refusal[:1].upper() + refusal[1:])}.</p>'
    if choice is None:
        return ""
    e, t = choice.error_interval, choice.cost_interval
    where = f", the worst of {choice.cases} cases ({_text(choice.error_case)})" if choice.cases > 1 else ""
    return (
        f'<div class="choice-box">For {_text(choice.asked)}:<br><b>{_text(choice.setting)}</b><br>'
        f"error {figure_text(e.value)} ({figure_text(e.low)} … {figure_text(e.high)}){where}, "
        f"{_interval(choice.unit, t)}<br>"
        f"<small>{_text(choice.metric)}, over: {_text(choice.mask)}</small></div>"
    )


def _front(study: Study, choice: Choice | None) -> str:
    ring = " The ring marks the choice." if choice is not None else ""
    worst = f", each with its worst over {len(study.cases)} cases" if len(study.cases) > 1 else ""
    axis = "time" if study.settings.get("cost", "time") == "time" else study.settings["cost"]
    return (
        f'<h2 id="front">Error against {_text(axis)}</h2>'
        f"<p>{_text(study.metric['name'])}, over {_text(study.mask['name'])}{worst}. Left and low is better. Bars are "
        f"95 % intervals; pale settings are beaten by another beyond confidence in both; beside the others stand their "
        f"knobs.{ring}</p>"
        f'<div class="wide">{chart.svg(study, 1000, 520, choice)}</div>'
        f'<div class="narrow">{chart.svg(study, 380, 380, choice)}</div>'
        f"{_legend(study)}"
    )


def _legend(study: Study) -> str:
    techniques = list(dict.fromkeys(r.technique for r in study.records))
    legend = "".join(
        f'<span><svg viewBox="-8 -8 16 16"><path d="{marker_path(i, 0, 0)}" fill="{COLORS[i % len(COLORS)]}"/></svg>'
        f"{_text(t)}</span>"
        for i, t in enumerate(techniques)
    )
    return f'<div class="legend">{legend}</div>'


def _figures(study: Study, choice: Choice | None) -> str:
    chosen = (choice.technique, choice.knobs) if choice is not None else None
    threads, cpu, unit = study.machine["threads"], study.machine["cpu"], study.cost_unit()
    timed = study.settings.get("cost", "time") == "time"
    shown = f"<b>{unit.short}</b>: {unit.long}" + ("" if timed else "; <b>ms</b>: milliseconds a frame")
    return (
        '<h2 id="figures">Figures</h2>'
        f"<p>Cheapest first; ★ is on the front. {shown}, median, on {_text(threads)} threads "
        f"of {_text(cpu)}, preparation included. Counters (taps, rays, bytes) carry to other machines; times do not: "
        "<b>ranks may differ on a GPU</b>.</p>"
        f'<div class="scroll">{html_table(study, chosen, "cost")}</div>{_causes(study, chosen)}'
        '<p class="soft">All figures, setting by setting and case by case: <a href="figures.csv">figures.csv</a>, '
        '<a href="figures.json">figures.json</a>; the front as a picture: <a href="front.png">front.png</a>.</p>'
    )


def _causes(study: Study, chosen: tuple[str, dict[str, object]] | None) -> str:
    """Errors by cause, where any can be told."""
    if all(v is None for r in study.records for v in (r.bias, r.noise, r.precision)) and not study.also:
        return ""
    return (
        "<h3>Where errors come from</h3><p>Each is the worst over the cases. <b>Bias</b> stays whatever the seed, "
        "<b>noise</b> changes with it, <b>precision</b> is float32 against the same technique in float64.</p>"
        f'<div class="scroll">{html_table(study, chosen, "cause")}</div>'
    )


def _cases(study: Study, choice: Choice | None) -> str:
    """The error over the cases, and every figure case by case, of the settings whose pictures are shown."""
    if len(study.cases) < 2:
        return ""
    settings = study.few()
    if choice is not None and (choice.technique, choice.knobs) not in settings:
        settings.append((choice.technique, choice.knobs))
    out = [
        '<h2 id="cases">Case by case</h2>',
        "<p>Where a technique holds, and where it breaks. Hollow marks are further settings of the same technique.</p>",
        f'<div class="wide">{chart.cases_svg(study, settings, 1000)}</div>',
        f'<div class="narrow">{chart.cases_svg(study, settings, 380)}</div>',
        _legend(study),
    ]
    for title, table in cases_table(study, settings):
        # A page is narrow, and cases have shorter names than settings: these stand in rows.
        head, *rows = zip(*table, strict=True)
        heads = "".join(f"<th>{_text(name)}</th>" for name in head)
        body = "".join("<tr>" + "".join(f"<td>{_text(cell)}</td>" for cell in row) + "</tr>" for row in rows)
        out.append(f'<h3>{_text(title)}</h3><div class="scroll"><table class="shadelab-table cases"><tr>{heads}</tr>')
        out.append(f"{body}</table></div>")
    return "".join(out)


def _pictures(study: Study, strips: list[CaseStrip]) -> str:
    if not strips:
        return ""
    low, high = (study.metric.get(k, default) for k, default in (("low", "too dark"), ("high", "too bright")))
    out = [
        '<h2 id="pictures">Pictures, and where the error sits</h2>',
        "<p>The most accurate setting of each technique and the choice, or all if few. Difference maps are signed: "
        f'<span class="scale"></span> from {_text(low)} to {_text(high)}, paler outside the mask. Pictures here are '
        "compressed; each is a link to its file in full, and EXR files with the linear values lie beside.</p>",
    ]
    for strip in strips:
        case = strip.case
        out.append(f"<h3>{_text(case.name)}</h3>")
        out.append(
            f'<p class="soft">Difference maps from −{strip.scale:.3g} to {strip.scale:.3g}. {_reference(case)}</p>'
        )
        for _, pictures in strip.rows:
            out.append('<div class="strip">')
            for p in pictures:
                out.append(
                    f'<figure><a href="{_text(p.file)}"><img src="{p.data}" alt="{_text(p.alt)}"></a>'
                    f"<figcaption>{_text(p.caption)}</figcaption></figure>"
                )
            out.append("</div>")
        for line in case.left_out:
            out.append(f'<p class="soft">Not measured here: {_text(line)}.</p>')
    return "".join(out)


def _reference(case: object) -> str:
    """What a case's reference can judge, in a sentence."""
    from .records import CaseRecord

    assert isinstance(case, CaseRecord)
    if not case.reference_samples:
        return "The reference is exact."
    kept = ", kept from an earlier run" if case.cached else ""
    verdict = (
        f"within the {figure_text(case.target)} that was asked"
        if case.reached
        else f"more than the {figure_text(case.target)} that was asked, when its time ran out"
    )
    return (
        f"Reference: two halves of {case.reference_samples} samples, {case.reference_seconds:.1f} s{kept}; its own "
        f"error is {figure_text(case.reference_error)}, {verdict}."
    )


def _plans(study: Study) -> str:
    plans: dict[str, list[str]] = {}
    for c in study.cases:
        if c.plan:
            plans.setdefault(c.plan_html or f"<pre>{_text(c.plan)}</pre>", []).append(c.name)
    if not plans:
        return ""
    out = ['<h2 id="plan">The plan</h2><p>The passes that each scene requires, and what was left out.</p>']
    for text, names in plans.items():
        out.append(f'<h3>{_text("; ".join(names))}</h3><div class="scroll">{text}</div>')
    return "".join(out)


def _measured(study: Study) -> str:
    s = study.settings
    rows = "".join(
        f"<tr><td>{_text(c.name)}</td><td>{c.mask_share:.1%}</td><td>{_text(_reference(c))}</td></tr>"
        for c in study.cases
    )
    element = s.get("element", "pixel")
    size = " × ".join(str(n) for n in s["size"])
    size = f"{size} pixels" if element == "pixel" else f"{size} {element}s in each case"
    noisy = (
        "<p>Errors are taken against two independent halves A and B of the reference: the mean of "
        "(x − A)(x − B) is the squared error free of the reference's noise. The reference is refined until its own "
        f"error is {s['fraction']:g} of the smallest error that it judges, or its {s['reference_seconds']:g} s run "
        "out. "
        if any(c.reference_samples for c in study.cases)
        else "<p>References are exact. "
    )
    return (
        '<h2 id="measured">How it was measured</h2>'
        f"<p>At {size}, seed {_text(s['seed'])}. After one run that is not counted, all settings of a case "
        f"are timed in turn, up to {s['rounds']} rounds in changing order; a setting that has used {s['patience']:g} s "
        "is left alone after three. Time is the median with its interval between order statistics (95 % from six "
        f"rounds on).</p>{noisy}Intervals of errors are a bootstrap over tiles of the picture, on draws common to "
        "all settings. A bound is kept only if the upper end of the interval keeps it, in the worst case.</p>"
        '<div class="scroll"><table class="plain"><tr><th>case</th><th>mask</th><th>reference</th></tr>'
        f"{rows}</table></div>"
    )


def _machine(study: Study) -> str:
    rows = "".join(f"<dt>{_text(k)}</dt><dd>{_text(v)}</dd>" for k, v in study.machine.items())
    return (
        f'<h2 id="machine">The machine</h2><dl>{rows}</dl>'
        "<p>Times are this machine's. A GPU filters taps in hardware and traces rays in its own units: ranks may "
        "differ there, while errors and counters stay.</p>"
    )


def _glossary(study: Study) -> str:
    entries = [
        (f"{study.word}: {study.metric['name']}", study.metric["about"]),
        (f"mask: {study.mask['name']}", study.mask["about"]),
    ]
    entries += [(n, t) for n, t in study.also.items() if t]
    entries += [(n, t) for n, t in study.techniques.items() if t]
    items = "".join(f"<dt>{_text(n)}</dt><dd>{_text(t)}</dd>" for n, t in entries)
    return f'<h2 id="glossary">Glossary</h2><dl>{items}</dl>'
