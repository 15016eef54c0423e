"""Scenes take the models of `brdf` as materials."""

import numpy as np
import pytest
from shadelab import brdf, mesh, scene


def test_rows_stand_for_the_models():
    ball = mesh.icosphere(1)
    glass, gold, plain = brdf.Dielectric(1.33), brdf.RoughConductor(0.2, k=3.0), scene.Material((0.1, 0.2, 0.3))
    things = [scene.Instance(ball, None, m) for m in (glass, gold, plain, brdf.Dielectric(1.33))]
    arrays = scene.Scene(things).flatten()
    assert arrays.materials == (glass, gold, plain) and set(arrays.material_ids.tolist()) == {0, 1, 2}
    assert arrays.kinds.tolist() == [3, 4, 0] and arrays.rows.dtype == np.float32
    np.testing.assert_allclose(arrays.rows[2, :6], [0.1, 0.2, 0.3, 0, 0.5, 1], rtol=1e-6)
    np.testing.assert_allclose(arrays.rows[0, :4], [1, 1, 1, 1.33], rtol=1e-6)
    assert arrays.metallic.tolist() == [0, 1, 0] and not arrays.emission.any()


def test_a_scene_wants_lone_numbers():
    with pytest.raises(ValueError, match="alpha: expected one value"):
        scene.Instance(mesh.icosphere(1), None, brdf.RoughConductor(np.array([0.1, 0.2])))
