"""The question of rays and spheres: its reference is exact, and it finds the silhouettes that fray."""

import mpmath
import numpy as np
import pytest
from shadelab import study
from shadelab.study import Case
from shadelab.study.questions import _rays, ray_sphere

FAST = {"size": (64, 64), "rounds": 1, "patience": 0.0, "causes": False}
CASES = [(n, v) for n, s in ray_sphere._SCENES.items() for v in ray_sphere._views(n, s).values()]


@pytest.mark.parametrize(("name", "view"), CASES)
def test_the_reference_is_exact(name, view):
    inputs = ray_sphere._setup(Case(name, "", ray_sphere._SCENES[name], view, (12, 12), np.dtype(np.float32), 0))
    hits = 0
    with mpmath.workprec(400):
        for i in np.ndindex(12, 12):
            o, d, c = (
                [mpmath.mpf(float(x)) for x in v[i][0]]
                for v in (inputs.origins, inputs.directions, inputs.primitives[0])
            )
            r = mpmath.mpf(float(inputs.primitives[1][i][0]))
            f = [x - y for x, y in zip(o, c, strict=True)]
            dd, df, ff = (sum(x * y for x, y in zip(u, v, strict=True)) for u, v in ((d, d), (d, f), (f, f)))
            room = df**2 - dd * (ff - r**2)
            roots = [] if room < 0 else [t for s in (-1, 1) if (t := (-df + s * mpmath.sqrt(room)) / dd) > 0]
            hits += bool(roots)
            if not roots:
                assert inputs.exact[i] == -1
            else:
                # Close to a tangent the root has half of the digits of what is under it.
                slack = 1e-14 + 1e-15 * abs(df) / mpmath.sqrt(room) if room else 1
                assert abs(inputs.exact[i] / roots[0] - 1) < slack
    assert 10 < hits < 144


def test_the_robust_test_holds_at_every_distance_and_the_textbooks_dissolve():
    result = study.run("ray sphere", "4000 radii away", **FAST)
    error = {(r.setting, r.view): r.error.value for r in result.records}
    assert error["robust(precision=single)", "the sphere"] < 2 * _rays.EPS
    assert error["quadratic(precision=single)", "the sphere"] > 0.1
    assert error["geometric(precision=single)", "the sphere"] > 0.1
    assert error["quadratic(precision=double)", "the sphere"] < 1e-9


def test_rays_that_leave_a_surface_meet_it_again_by_the_textbook():
    result = study.run("ray sphere", "radius 1e6", **FAST)
    records = {r.setting: r for r in result.records if r.view == "leaving the surface"}
    assert records["robust(precision=single)"].also["invented per million"] == 0
    assert records["robust(precision=single)"].also["lost per million"] == 0
    assert records["quadratic(precision=single)"].error.value > 0.1


def test_it_runs_whole():
    result = study.run("ray sphere", **FAST)
    assert len(result.cases) == 18 and len(result.records) == 18 * 6
    assert result.pick(max_error=1e-5).knobs == {"precision": "double"}
    with pytest.raises(ValueError, match="or takes a Ball"):
        study.run("ray sphere", 3, **FAST)
