"""A plan picks for every material the cheapest model and method that keep the bound, and states the error as it is."""

from dataclasses import replace

import numpy as np
import pytest
import shadelab as sl
from shadelab import brdf
from shadelab.light import PointLight, RectLight
from shadelab.scene import Camera, Instance, Material, Scene

FLOOR = sl.mesh.plane(6.0)
CAMERA = Camera((0, 2, 4), (0, 0, 0))
PANEL = RectLight((0, 1.2, -0.5), (2, 0, 0), (0, 0.6, 0.8), (5, 5, 5))
LAMP = PointLight((1, 2, 0), (9, 9, 9))


def way(material, light, **bounds):
    (found,) = sl.plan(Scene(Instance(FLOOR, None, material), light, CAMERA), (64, 36), **bounds).shading
    return found


def test_a_diffuser_needs_no_mirrors():
    found = way(Material((0.5, 0.4, 0.3), specular=0.0), PANEL)
    assert (found.kind, found.samples) == ("diffuse", 0) and found.error < 1e-5
    assert "closed form" in found.reason and "metallic roughness is not needed" in found.reason
    assert isinstance(found.model, brdf.Diffuse)


def test_compensation_only_where_its_loss_is_above_the_bound():
    smooth, rough = (brdf.RoughConductor(a, compensation="kulla_conty") for a in (0.02, 1.0))
    assert way(smooth, LAMP).kind in ("metallic roughness", "rough conductor")
    found = way(rough, LAMP)
    assert found.kind == "rough conductor with compensation" and found.error < 1e-6
    # The same rough metal may do without where much may be lost.
    assert way(rough, LAMP, max_error=0.9).kind == "metallic roughness"
    # By about what it would lose: some 59 % of the light in a furnace, less of copper.
    assert 0.2 < float(found.reason.split("off by ")[1].rstrip("%")) / 100 < 0.7


def test_glass_goes_without_compensation_where_little_is_lost():
    smooth, rough = (brdf.RoughDielectric(a, compensation="kulla_conty") for a in (0.02, 1.0))
    assert way(smooth, LAMP).kind == "rough dielectric"
    assert way(rough, LAMP, max_error=0.01).kind == "rough dielectric with compensation"


def test_transformed_cosines_where_an_area_light_meets_a_glossy_surface():
    glossy = Material((0.9, 0.6, 0.4), 1.0, 0.5)
    assert way(glossy, PANEL, max_error=0.1).method == "ltc"
    assert "transformed cosines" in way(glossy, PANEL, max_error=0.1).reason
    assert way(glossy, LAMP).reason.startswith("punctual lights alone")
    far = RectLight((0, 60, 0), (1, 0, 0), (0, 0, 1), (3e4, 3e4, 3e4))
    found = way(glossy, far)
    assert found.method == "point" and found.error < 0.02


def test_tighter_bounds_cost_more_and_are_kept():
    glossy = Material((0.6, 0.3, 0.2), 0.0, 0.4)
    errors, samples = [], []
    for bound in (0.3, 0.05, 0.01):
        found = way(glossy, PANEL, max_error=bound)
        errors.append(found.error)
        samples.append(found.samples if found.method == "sampling" else 0)
        assert found.error <= bound
    assert samples == sorted(samples)


def test_a_budget_seeks_the_least_error():
    # So rough that a few samples are closer than transformed cosines.
    glossy = Material((0.9, 0.6, 0.4), 1.0, 0.8)
    loose, tight = way(glossy, PANEL, budget_ms=1000.0), way(glossy, PANEL, budget_ms=0.3)
    assert loose.error < tight.error
    assert loose.method == "sampling" and tight.method != "sampling"


def test_stated_errors_are_those_of_the_picture():
    glossy = Material((0.9, 0.6, 0.4), 1.0, 0.5)
    scene = Scene(Instance(FLOOR, None, glossy), PANEL, CAMERA)
    plan = sl.plan(scene, (96, 54), max_error=0.1)
    full = replace(plan, shading=(replace(plan.shading[0], model=glossy, method="sampling", samples=2048),))
    a, b = (sl.render(scene, p) for p in (plan, full))
    seen = a.face >= 0
    apart = np.sqrt(np.mean((a.radiance[seen] - b.radiance[seen]) ** 2)) / b.radiance[seen].mean()
    assert apart == pytest.approx(plan.shading[0].error, rel=0.25)


def test_plans_say_what_they_chose_and_why():
    things = [Instance(FLOOR, None, Material(name="floor")), Instance(sl.mesh.box(0.5), None, brdf.Plastic())]
    plan = sl.plan(Scene(things, LAMP, CAMERA), (64, 36))
    text, table = str(plan), plan._repr_html_()
    for x in plan.shading:
        assert x.material in text and x.reason in text and x.reason in table and f"{x.error:.1%}" in text
    assert plan.shading[0].material == "floor"
    hidden = Instance(sl.mesh.box(0.1), sl.transform.translate([0, -1, 0]), Material(name="hidden"))
    (*_, last) = sl.plan(Scene([*things, hidden], LAMP, CAMERA), (64, 36)).shading
    assert np.isnan(last.error) and "not measured" in last.reason


def test_plans_of_other_materials_are_refused():
    one = Scene([Instance(FLOOR)], LAMP, CAMERA)
    two = Scene([Instance(FLOOR), Instance(sl.mesh.box(0.2), None, Material((0.1, 0.1, 0.1)))], LAMP, CAMERA)
    with pytest.raises(ValueError, match="plan: made for another scene, with 1 materials instead of 2"):
        sl.render(two, sl.plan(one, (8, 8)))


@pytest.mark.parametrize("frequency", ["flat", "gouraud", "phong"])
def test_frequencies_agree_on_a_matte_plane_and_part_at_highlights(frequency):
    fine = Instance(sl.mesh.plane(6.0), None, Material(specular=0.0))
    far = PointLight((0, 200, 0), (1e5, 1e5, 1e5))
    scene = Scene(fine, far, CAMERA)
    frame = sl.render(scene, sl.plan(scene, (64, 36), frequency=frequency))
    exact = sl.render(scene, size=(64, 36))
    seen = frame.face >= 0
    assert np.allclose(frame.radiance[seen], exact.radiance[seen], rtol=1e-3)
    lamp = PointLight((2, 3, 3), (9, 9, 9))
    ball = Scene(sl.mesh.icosphere(2), lamp, Camera((0, 0.5, 3), (0, 0, 0)))
    frame = sl.render(ball, sl.plan(ball, (64, 48), frequency=frequency))
    smooth = sl.render(ball, size=(64, 48))
    seen = frame.face >= 0
    apart = np.sqrt(np.mean((frame.radiance[seen] - smooth.radiance[seen]) ** 2)) / smooth.radiance[seen].mean()
    assert {"flat": 0.1 < apart < 0.5, "gouraud": 0.02 < apart < 0.3, "phong": apart == 0}[frequency]
    if frequency == "flat":
        # One value a face.
        for face in np.unique(frame.face[seen])[:10]:
            assert len(np.unique(frame.radiance[frame.face == face], axis=0)) == 1
    with pytest.raises(ValueError, match="frequency"):
        sl.plan(ball, (8, 8), frequency="sometimes")


def test_each_light_has_its_own_method_where_that_is_cheaper():
    """A lamp near a glossy floor needs cosines or samples; one far away is a point, whatever the other needs."""
    near = RectLight((0, 0.6, -0.5), (1.5, 0, 0), (0, 0, 0.8), (5, 5, 5))
    far = RectLight((40, 60, 20), (1, 0, 0), (0, 0.3, 0.8), (30000, 30000, 30000))
    glossy = Material((0.9, 0.8, 0.6), metallic=1.0, roughness=0.5)
    camera = Camera((0.3, 1.0, 3.0), (0, 0, 0.1), fov_y=0.35)
    scene = Scene(Instance(sl.mesh.plane(20.0), None, glossy), [near, far], camera)
    plan = sl.plan(scene, (32, 18))
    (way,) = plan.shading
    methods = [m for m, _ in way.by_light]
    assert methods[1] == "point" and methods[0] != "point", str(plan)
    assert way.error <= 0.02 and "by light" in str(plan) and "the cheapest for each light" in str(plan)
    frame = sl.render(scene, plan)
    traced = sl.pathtrace.path_trace(
        scene, (32, 18), 256, max_depth=1, filter=sl.pathtrace.PixelFilter("box", 1e-3), seed=7
    )
    apart = np.sqrt(np.mean((frame.radiance - traced.radiance) ** 2)) / traced.radiance.mean()
    assert apart < 1.5 * way.error + 1.2 * np.sqrt(traced.variance.mean()) / traced.radiance.mean()
    # The same at vertices, light by light.
    assert np.isfinite(sl.render(scene, sl.plan(scene, (32, 18), frequency="gouraud")).radiance).all()


def test_layers_are_noted_whether_they_matter_or_not():
    coated = brdf.Principled((0.6, 0.1, 0.1), roughness=0.8, clearcoat=1.0, sheen=0.0)
    assert "clear coat" in way(coated, LAMP).reason and "sheen" not in way(coated, LAMP).reason
    cloth = brdf.Principled((0.6, 0.1, 0.1), roughness=1.0, specular=0.0, sheen=1.0)
    assert "with its sheen: no simpler model has that" in way(cloth, LAMP).reason
    faint = way(brdf.Principled((0.6, 0.1, 0.1), roughness=1.0, specular=0.0, sheen=1e-6), LAMP, max_error=0.5)
    assert faint.kind != "principled" and "nor its sheen" in faint.reason
