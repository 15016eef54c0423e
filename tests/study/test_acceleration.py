"""The question of acceleration: its scenes, that hits are checked, and what it finds of each structure."""

import dataclasses

import numpy as np
import pytest
import shadelab as sl
from shadelab import study
from shadelab.study.questions import _acceleration_scenes, acceleration

FAST = {"size": (48, 27), "rounds": 2, "patience": 0.0}


@pytest.fixture(scope="module")
def measured():
    return study.run("acceleration", "teapot in a stadium", **FAST)


def case_of(scene, view="random rays"):
    return study.Case("mine", view, scene, _acceleration_scenes.RAYS[view], (32, 18), np.dtype(np.float32), 0)


def counters(result, technique, view):
    return [r.counters for r in result.records if r.technique == technique and r.view == view]


@pytest.mark.parametrize("name", _acceleration_scenes.SCENES)
def test_scenes_are_of_one_size_and_both_kinds_of_rays_meet_them(name):
    mesh = _acceleration_scenes.SCENES[name]()
    assert 5_000 < len(mesh.faces) < 7_000
    bvh = sl.accel.BVH(mesh.positions, mesh.faces)
    for view in _acceleration_scenes.RAYS:
        inputs = acceleration._setup(case_of(mesh, view))
        hit = bvh.closest_hit(inputs.origins, inputs.directions)
        assert 0.03 < (hit.face >= 0).mean() <= 1, view


def test_every_structure_is_measured_in_every_case(measured):
    settings = {(r.technique, *r.knobs.values()) for r in measured.records}
    assert {t for t, *_ in settings} == {"BVH", "grid", "octree", "kd-tree", "BSP tree"} and len(settings) == 8
    assert len(measured.records) == 2 * len(settings)
    for r in measured.records:
        assert (
            r.error.value > 0 and r.ms.value > 0 and r.counters["triangles/ray"] > 0 and r.counters["bytes/face"] > 36
        )
        assert r.bias is None and r.noise is None and r.precision is None


def test_the_stadium_defeats_the_grid_and_no_tree(measured):
    """Counts carry to every machine: the torus lies in few cells of the grid."""
    for view in _acceleration_scenes.RAYS:
        grid = min(c["triangles/ray"] for c in counters(measured, "grid", view))
        for tree in ("BVH", "octree", "kd-tree"):
            assert min(c["triangles/ray"] for c in counters(measured, tree, view)) < 0.3 * grid, tree


def test_a_choice_keeps_its_bound_and_the_report_shows_the_front(measured, tmp_path):
    slowest = max(r.error.value for r in measured.records)
    choice = measured.pick(max_error=slowest)
    assert choice.error <= slowest
    page = measured.report(tmp_path, max_error=slowest).read_text()
    assert "time of the build" in page and "boxes/ray" in page and "<svg" in page and "stadium" in page
    assert "boxes/ray" in measured.table()


def test_wrong_hits_are_refused():
    inputs = acceleration._setup(case_of(_acceleration_scenes.uniform()))
    good = inputs.structure(sl.accel.BVH, {})
    assert inputs.structure(sl.accel.BVH, {}) is good

    class Wrong(sl.accel.BVH):
        def closest_hit(self, *rays, **options):
            hit = super().closest_hit(*rays, **options)
            return hit._replace(u=np.nextafter(hit.u, np.float32(2)))

    with pytest.raises(AssertionError, match="differ from those of another"):
        inputs.structure(Wrong, {})
    fresh = dataclasses.replace(inputs, built={}, expected=None)
    with pytest.raises(AssertionError, match="differ from brute force"):
        fresh.structure(Wrong, {})


def test_a_scene_of_ones_own_is_taken_and_an_empty_one_refused():
    scene = sl.scene.Scene([sl.mesh.icosphere(2)])
    result = study.run("acceleration", scene, techniques=["grid"], **FAST)
    assert {r.scene for r in result.records} == {"your scene"}
    with pytest.raises(ValueError, match="at least one face in 'mine'"):
        acceleration._setup(case_of(sl.mesh.Mesh(np.zeros((3, 3)), np.zeros((0, 3), int))))
    with pytest.raises(TypeError, match="expected 'mine' to be a Mesh or a Scene"):
        acceleration._setup(case_of(7))
