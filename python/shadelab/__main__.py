"""The command line: `python -m shadelab study | render | techniques | stability`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

__all__ = ["main"]

MODELS = "obj, ply, stl, glb or gltf"


class _Parser(argparse.ArgumentParser):
    """A parser that says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"shadelab: {message} (see {self.prog} --help)\n")


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(n) for n in text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT such as 1280x720, got {text!r}") from None
    if not (1 <= width <= 16384 and 1 <= height <= 16384):
        raise argparse.ArgumentTypeError(f"expected sides from 1 to 16384, got {text!r}")
    return width, height


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a positive number, got {text!r}")
    return value


def _count(low: int, high: int | None = None) -> Any:
    bound = f"at least {low}" if high is None else f"from {low} to {high}"

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = low - 1
        if value < low or (high is not None and value > high):
            raise argparse.ArgumentTypeError(f"expected an integer, {bound}, got {text!r}")
        return value

    return parse


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="python -m shadelab", description="The laboratory of real-time rendering for NumPy.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=_Parser)

    study = commands.add_parser("study", help="measure what techniques cost and what they lose; write a report")
    study.add_argument(
        "subject",
        nargs="*",
        help=f"what to ask, such as acceleration, and your own mesh ({MODELS}); the question's scenes otherwise",
    )
    study.add_argument("--question", help="what to ask (default: soft shadows)")
    bound = study.add_mutually_exclusive_group()
    bound.add_argument(
        "--max-error", type=_positive, help="choose the cheapest with this error (default: the question's own)"
    )
    bound.add_argument("--budget-ms", type=_positive, help="choose the most accurate within these milliseconds a frame")
    study.add_argument("--size", type=_size, help="of the pictures, such as 1280x720 (default: the question's own)")
    study.add_argument("--threads", type=_count(1, 4096), help="threads to measure with (default: one a core)")
    study.add_argument("--out", type=Path, default=Path("shadelab-report"), help="where to (default: shadelab-report)")
    study.add_argument("--seed", type=_count(0, 2**64 - 1), default=0, help="of everything random (default: 0)")
    study.add_argument("--no-cache", action="store_true", help="neither read nor keep references")
    study.set_defaults(run=_study)

    render = commands.add_parser("render", help="render a scene in real-time style, or its reference")
    render.add_argument("scene", help=f"a scene or mesh ({MODELS}), or 'default'")
    render.add_argument("-o", "--out", type=Path, required=True, help="the picture: .png, .exr or .hdr")
    render.add_argument("--reference", action="store_true", help="path trace instead")
    render.add_argument("--samples", type=_count(1), default=64, help="paths a pixel of the reference (default: 64)")
    render.add_argument("--size", type=_size, default=(1280, 720), help="of the picture (default: 1280x720)")
    render.add_argument("--threads", type=_count(1, 4096), help="threads to use (default: one a core)")
    render.add_argument("--seed", type=_count(0, 2**64 - 1), default=0, help="of everything random (default: 0)")
    render.set_defaults(run=_render)

    techniques = commands.add_parser("techniques", help="what there is, by chapter, with its source")
    techniques.add_argument("chapter", nargs="?", help="one chapter alone")
    techniques.set_defaults(run=_techniques)

    stability = commands.add_parser("stability", help="every kernel at the extremes of its domain")
    stability.add_argument("chapter", nargs="?", help="one chapter alone")
    stability.set_defaults(run=_stability)
    return parser


def _study(options: argparse.Namespace) -> int:
    from . import scene, study

    name, model = _subject(options.subject, options.question)
    question = study.find(name)
    max_error, budget_ms = options.max_error, options.budget_ms
    if max_error is None and budget_ms is None:
        max_error = question.max_error
    out: Path = options.out
    if out.exists() and not out.is_dir():
        raise NotADirectoryError(f"{out}: not a directory")
    out.mkdir(parents=True, exist_ok=True)
    scenes = None if model is None else {model.stem: scene.load(model)}
    result = study.run(
        question,
        scenes,
        size=options.size,
        seed=options.seed,
        threads=options.threads,
        cache=not options.no_cache,
        progress=_progress(question.name),
    )
    print(result.table())
    if len(result.cases) > 1:
        print(f"\n{result.by_case()}")
    status = 0
    try:
        print(f"\nchoice: {result.pick(max_error=max_error, budget_ms=budget_ms)}")
    except study.NothingQualifies as error:
        print(f"\nno choice: {error}")
        status = 1
    for case in result.cases:
        if not case.reached:
            print(f"note: the reference of {case.name} ran out of time: its own error is {case.reference_error:.2g}")
    sys.stdout.flush()
    page = result.report(out, max_error=max_error, budget_ms=budget_ms)
    print(f"\nreport: {page}")
    return status


def _subject(given: Sequence[str], asked: str | None) -> tuple[str, Path | None]:
    """The question and the model, in this order, each of which may be missing."""
    from . import study

    rest = list(given)
    if rest and asked is None and rest[0].lower().replace("-", " ").replace("_", " ") in study.questions():
        asked = rest.pop(0)
    if len(rest) > 1:
        known = ", ".join(map(repr, study.questions()))
        raise ValueError(f"expected a question ({known}) and a model, got {' '.join(map(repr, given))}")
    return asked or "soft shadows", Path(rest[0]) if rest else None


def _render(options: argparse.Namespace) -> int:
    from . import scene
    from ._runtime import set_threads

    if options.out.suffix.lower() not in (".png", ".exr", ".hdr"):
        raise ValueError(f"{options.out}: expected a picture that ends in .png, .exr or .hdr")
    if not options.out.parent.is_dir():
        raise FileNotFoundError(f"{options.out.parent}: no such directory")
    if options.threads is not None:
        set_threads(options.threads)
    made = scene.default() if options.scene == "default" else scene.load(options.scene)
    if options.reference:
        _render_reference(made, options)
    else:
        from . import renderer

        frame = renderer.render(made, size=options.size)
        frame.save(options.out)
        for name, seconds in frame.times.items():
            print(f"{name:24} {seconds * 1e3:8.2f} ms")
    print(options.out)
    return 0


def _render_reference(made: Any, options: argparse.Namespace) -> None:
    from . import pathtrace, scene
    from .renderer.frames import displayed, png

    traced = pathtrace.path_trace(
        made, options.size, samples=options.samples, seed=options.seed, progress=_progress("path tracing")
    )
    if options.out.suffix.lower() == ".png":
        # By the same exposure and tone curve as a frame's.
        options.out.write_bytes(png(displayed(traced.radiance)))
    else:
        scene.save_image(options.out, traced.radiance)


def _progress(label: str) -> Any:
    """A bar where someone is looking; nothing in a log."""
    if not sys.stderr.isatty():
        print(f"{label} …", file=sys.stderr, flush=True)
        return _Dots()
    return True


class _Dots:
    """Progress in a log: a line every tenth of the way."""

    def __init__(self) -> None:
        self.told = 0

    def __call__(self, done: int, total: int) -> None:
        tenth = 10 * done // max(total, 1)
        if tenth > self.told:
            self.told = tenth
            print(f"{10 * tenth} %", file=sys.stderr, flush=True)


def _techniques(options: argparse.Namespace) -> int:
    from ._techniques import chapters, listing

    known = chapters()
    if options.chapter is not None and options.chapter not in known:
        raise ValueError(f"chapter: expected one of {', '.join(known)}, got {options.chapter!r}")
    print(listing([options.chapter] if options.chapter else known))
    return 0


def _stability(options: argparse.Namespace) -> int:
    from .study import stability

    rows = stability.measure(stability.extremes(options.chapter))
    print(stability.table(rows))
    failed = sum(not r.holds for r in rows)
    print(f"\n{len(rows)} claims, {failed} fail" if failed else f"\n{len(rows)} claims, all hold")
    return 1 if failed else 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; the exit status is returned: 2 for what the user can mend, said in one line."""
    options = _parser().parse_args(arguments)
    try:
        status: int = options.run(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        print("shadelab: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # Whoever read the output has left; Python would complain once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        name = f"{error.filename}: " if error.filename is not None else ""
        print(f"shadelab: {name}{_line(error.strerror or error)}", file=sys.stderr)
        return 2
    except (ValueError, ImportError) as error:
        print(f"shadelab: {_line(error)}", file=sys.stderr)
        return 2
    return status


def _line(message: object) -> str:
    return " ".join(str(message).split())


if __name__ == "__main__":
    sys.exit(main())
