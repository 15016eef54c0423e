"""What lookups ask: counted by hand, and counts that are none are named."""

import numpy as np
import pytest
from shadelab.shadow import Cost, cost


def test_reads_are_counted():
    assert cost("hard") == Cost(1, 0, 4)
    assert cost("pcf", samples=9, bilinear=True, itemsize=8) == Cost(36, 0, 288)
    assert cost("pcss", blocker_samples=np.int64(8), filter_samples=8.0) == Cost(16, 0, 64)
    assert cost("variance_soft", kind="variance", filter="summed_area") == Cost(32, 0, 32 * 2 * 8)
    assert cost("ray_traced", samples=7) == Cost(0, 7, 0)


@pytest.mark.parametrize(
    "technique, name",
    [
        ("pcf", "samples"),
        ("ray_traced", "samples"),
        ("distance_field", "max_steps"),
        ("pcss", "blocker_samples"),
        ("pcss", "filter_samples"),
    ],
)
@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan, -1])
def test_counts_that_are_none_are_named(technique, name, value):
    with pytest.raises(ValueError, match=name):
        cost(technique, **{name: value})
    with pytest.raises(TypeError, match=name):
        cost(technique, **{name: "many"})


def test_items_have_a_size():
    for wrong in (0, -4):
        with pytest.raises(ValueError, match="itemsize"):
            cost("hard", itemsize=wrong)
