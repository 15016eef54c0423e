"""Acne and gaps: counted as their definition says, and as theory predicts for a wall."""

import numpy as np
import pytest
import shadelab as sl

UP = [0.0, 1.0, 0.0]


def test_fractions_are_counted():
    exact = np.array([1.0, 1.0, 1.0, 0.5, 0.0, 0.0, np.nan])
    lit = np.array([1.0, 0.9, np.nan, 0.0, 0.2, 0.0, 0.0])
    assert sl.shadow.acne(lit, exact) == 0.5 and sl.shadow.acne(lit, exact, tolerance=0.1) == 0.0
    assert sl.shadow.detached(lit, exact) == 0.5 and sl.shadow.detached(lit, exact, tolerance=0.2) == 0.0
    assert np.isnan(sl.shadow.acne([0.0], [0.0])) and np.isnan(sl.shadow.detached([1.0], [1.0]))
    with pytest.raises(ValueError, match="lit: "):
        sl.shadow.acne(np.ones(3), np.ones(4))
    with pytest.raises(ValueError, match="tolerance"):
        sl.shadow.detached([1.0], [1.0], tolerance=1.0)


def test_gaps_are_lengths():
    line = np.stack([np.arange(6) * 0.5, np.zeros(6), np.zeros(6)], -1)
    exact = np.array([1, 0, 0, 0, 1, 1.0])
    gap = sl.shadow.detached_gap
    assert gap(exact, exact, line) == 0
    assert gap([1, 1, 0, 0, 1, 1.0], exact, line) == 0.5
    # Nothing dark until the shadow's end: all of it is gap.
    assert gap(np.ones(6), exact, line) == 1.5
    assert gap([0, 1, 1, 1, 1, 0.0], exact, line) == 1.5
    assert gap(np.zeros(6), np.ones(6), line) == 0
    both = gap(np.stack([exact, np.ones(6)]), np.stack([exact, exact]), np.stack([line, 2 * line]))
    assert both.tolist() == [0.0, 3.0]
    with pytest.raises(ValueError, match="receivers"):
        gap(np.ones(6), exact, line[:5])


def test_a_constant_bias_opens_the_gap_that_triangles_say(scenes):
    wall = np.array([[0.5, 0, -2], [0.5, 0, 2], [0.5, 1, 2], [0.5, 1, -2]]), np.array([[0, 1, 2], [0, 2, 3]])
    mesh = scenes.join(wall, scenes.quad(0.0, (-4, 4), (-4, 4), float))
    light = sl.light.PointLight((-2.0, 4.0, 0.0))
    m = sl.shadow.shadow_map(*mesh, light, 2048)
    x = np.linspace(0.5, 1.2, 4001)
    line = np.stack([x, 0 * x, 0 * x], -1)
    exact = sl.shadow.ray_traced(sl.accel.BVH(*mesh), line, np.broadcast_to(UP, line.shape), light)
    for bias in (0.05, 0.1):
        # Without the help of normals, so that depth alone decides. The map looks askew, along its own axis.
        lit = sl.shadow.hard(m, line, bias=bias)
        # A blocker nearer by the bias along the axis: on the ray from the light, at height h of the wall.
        to = line - m.position
        share = bias / (to @ m.frame[2])
        height = share * 4.0
        expected = x[np.argmax(height <= (x - 0.5) * 4.0 / (x + 2.0))] - 0.5
        assert sl.shadow.detached_gap(lit, exact, line) == pytest.approx(expected, abs=3 * m.texel_size(5.0))
    assert sl.shadow.detached_gap(sl.shadow.hard(m, line, UP), exact, line) <= 2 * m.texel_size(5.0)


def test_lines_without_points_have_no_gap():
    gap = sl.shadow.detached_gap(np.zeros((3, 0)), np.zeros((3, 0)), np.zeros((3, 0, 3)))
    assert gap.shape == (3,) and not gap.any()
