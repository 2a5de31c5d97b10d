"""Parts of [mesh] that stand in each other, and parts that only touch."""

import pytest

from strikewave.analyses.fem.build import build_model
from strikewave.base.errors import InputError
from strikewave.cases.case import parse_case

from .ball_case import edited


@pytest.mark.parametrize("height", [5.5, 4.0, 0.0, -1.0])
def test_parts_that_stand_in_each_other_are_refused_however_deep(height):
    """A ball of 10 mm radius whose lowest point is below the block's top at 4 mm by more than an element of 1 mm."""
    text = edited(('value = "14.01 mm"', f'value = "{10.0 + height - 3.0} mm"'), ('size = "2 mm"', 'size = "1 mm"'))
    with pytest.raises(InputError, match="stand beside each other"):
        build_model(parse_case(text))


def test_parts_that_touch_and_parts_that_only_share_a_box_may_stand_so():
    """The ball's box reaches over a block at its corner, the ball does not; and lowest point on top is no overlap."""
    for place in ('value = "14 mm"', 'value = "13.95 mm"'):
        build_model(parse_case(edited(('value = "14.01 mm"', place))))
    beside = edited(
        ('value = "14.01 mm"', 'value = "-3 mm"'), ('size = "2 mm"', 'size = "1 mm"\nat = { x = "14 mm", y = "12 mm" }')
    )
    build_model(parse_case(beside))
