"""What warps are held to, whatever they map onto."""

import numpy as np
import shadelab as sl
from scipy import stats

UNLIKELY = 1e-5
"""The level of the chi-square tests: seeds are fixed, so a failure is a defect."""


def numbers(n, dtype, seed=1):
    """Points of the unit square."""
    return sl.sampling.Generator(seed).uniform(np.arange(n)[:, None], 0, [0, 1], dtype)


def ends(dtype):
    """Every pair of the numbers at which a warp might slip."""
    one = dtype(1)
    edge = [0, np.finfo(dtype).smallest_subnormal, 1e-7, 0.25, 0.5, 0.75, np.nextafter(one, dtype(0)), one]
    return np.stack(np.meshgrid(np.array(edge, dtype), np.array(edge, dtype)), -1).reshape(-1, 2)


def fits(counts, expected):
    """Whether counts of cells come from these expected ones (cells of fewer than five are pooled)."""
    counts, expected = np.ravel(counts).astype(float), np.ravel(expected)
    few = expected < 5
    assert counts[expected == 0].sum() == 0
    if few.any():
        counts = np.append(counts[~few], counts[few].sum())
        expected = np.append(expected[~few], expected[few].sum())
        if expected[-1] < 5:
            counts, expected = counts[:-1], expected[:-1]
    expected = expected * counts.sum() / expected.sum()
    return stats.chisquare(counts, expected).pvalue > UNLIKELY


def sphere_cells(directions, heights=24, turns=48):
    """Counts in cells of equal solid angle."""
    z, turn = directions[..., 2], np.arctan2(directions[..., 1], directions[..., 0])
    window = [(-1, np.nextafter(1, 2)), (-np.pi, np.nextafter(np.pi, 4))]
    return np.histogram2d(z.ravel(), turn.ravel(), (heights, turns), window)[0]


def density_cells(pdf, n, heights=24, turns=48, inner=24):
    """What `sphere_cells` of n directions of this density should be, by the midpoint rule on a grid in each cell."""
    z = (np.arange(heights * inner) + 0.5) / (heights * inner) * 2 - 1
    turn = ((np.arange(turns * inner) + 0.5) / (turns * inner) * 2 - 1) * np.pi
    r = np.sqrt(1 - z**2)[:, None]
    points = np.stack(np.broadcast_arrays(r * np.cos(turn), r * np.sin(turn), z[:, None]), -1)
    values = pdf(points).reshape(heights, inner, turns, inner).mean((1, 3))
    return n * values * 4 * np.pi / (heights * turns)
