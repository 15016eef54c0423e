"""What moves while the shutter is open: all pixels share the moments, and their means are right all the same."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh, scene

WIDTH = 16


def passing_card(shutter=(0.0, 1.0)):
    """A black card that passes from left to right before a white background, filling the picture's height."""
    card = mesh.plane((1.0, 40.0))
    upright = sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    at = [sl.transform.translate((x, 0, 0)) @ upright for x in (-1.2, 0.9)]
    black = scene.Material((0, 0, 0), specular=0.0)
    camera = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=np.radians(30), shutter=shutter)
    return scene.Scene([scene.Instance(card, at[0], (black,), transform_end=at[1])], (), camera, background=(1, 1, 1))


def expected(shutter=(0.0, 1.0)):
    """The share of time and of each pixel's width that the card leaves free."""
    half = 4 * np.tan(np.radians(15))
    x = (np.arange(WIDTH * 64) + 0.5) / (WIDTH * 64) * 2 * half - half
    time = np.linspace(*shutter, 4001)[:, None]
    free = np.abs(x - (-1.2 + 2.1 * time)) > 0.5
    return free.mean(0).reshape(WIDTH, 64).mean(-1)


@pytest.mark.parametrize(("samples", "seeds"), [(1, 400), (100, 8)])
def test_means_over_the_shutter_are_unbiased(samples, seeds):
    world = passing_card()
    pictures = [sl.pathtrace.path_trace(world, (WIDTH, WIDTH), samples, seed=s).radiance for s in range(seeds)]
    columns = np.mean(pictures, axis=(1, 3))
    error = columns.std(0, ddof=1) / np.sqrt(seeds)
    # Five standard errors over sixteen columns: one false alarm in a hundred thousand; and the reference's own grid.
    np.testing.assert_array_less(np.abs(columns.mean(0) - expected()), 5 * error + 2e-3)


def test_moments_are_spread_evenly_over_the_shutter():
    """64 moments see each place of the ramp to a 64th: chance would miss by an eighth of its spread."""
    columns = sl.pathtrace.path_trace(passing_card(), (WIDTH, WIDTH), 256, seed=3).radiance.mean((0, 2))
    np.testing.assert_allclose(columns, expected(), atol=2.5 / 64)


def test_a_shorter_shutter_sees_less_of_the_way():
    shutter = (0.25, 0.5)
    columns = sl.pathtrace.path_trace(passing_card(shutter), (WIDTH, WIDTH), 256, seed=5).radiance.mean((0, 2))
    np.testing.assert_allclose(columns, expected(shutter), atol=2.5 / 64)
