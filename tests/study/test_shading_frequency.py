"""The question of shading frequency: what it must find whatever the machine."""

import pytest
from shadelab import study

FAST = {"size": (96, 72), "rounds": 1, "patience": 0.0, "causes": False}


def test_pixels_beat_vertices_beat_faces_and_finer_meshes_help():
    result = study.run("shading frequency", **FAST)
    found = {(r.scene, r.setting): r.error.value for r in result.records}

    def error(scene, name, n):
        return found[scene, f"{name}(subdivisions={n})"]

    for scene in ("matte", "roughness 0.6", "roughness 0.35", "metal, roughness 0.3"):
        for n in (2, 3, 4):
            # A narrow highlight may miss coarse vertices altogether, or stand on one.
            if "metal" not in scene:
                assert error(scene, "gouraud", n) < error(scene, "flat", n)
            assert error(scene, "phong", n) < min(error(scene, "gouraud", n), error(scene, "flat", n))
        for name in ("flat", "gouraud", "phong"):
            assert error(scene, name, 5) < 0.5 * error(scene, name, 2)
    # A highlight needs more vertices than a diffuser.
    assert error("roughness 0.35", "gouraud", 3) > error("matte", "gouraud", 3)


def test_scenes_of_other_kinds_are_refused():
    with pytest.raises(ValueError, match="this question has scenes of its own"):
        study.run("shading frequency", {"mine": 3}, **FAST)
