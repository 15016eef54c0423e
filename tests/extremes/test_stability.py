"""Every claim of the stability table, one test a kernel, extreme and precision."""

import numpy as np
import pytest
from shadelab.study import stability


@pytest.mark.parametrize(
    ("case", "dtype"),
    [pytest.param(e, d, id=f"{e.kernel}-{e.name}-{d}") for e in stability.extremes() for d in e.claim],
)
def test_claim_holds_at_the_extreme(case, dtype):
    result = case.measure(np.dtype(dtype))
    assert result.cases > 0
    assert result.strays == 0
    assert result.error <= case.claim[dtype]
