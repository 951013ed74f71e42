"""Loops that are none: numbers out of all size, texts that no file can hold."""

from __future__ import annotations

from typing import Any

import pytest
from strainwave.rig.loop import Loop


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"angle": [0.0, 1e300]}, r"angle: the largest is 1e\+300 in SI units; it must be 0 or lie in \[1e-30, 1e\+12\]"),
        ({"torque": [0.0, 5e-324]}, "torque: the largest is 4.94066e-324 in SI units"),
        ({"angle_scale": 1e300}, r"angle_scale = 1e\+300 1 must lie in \[0, 1e\+12\]"),
        ({"position": 1e300}, r"position = 1e\+300 rad must lie in \[-1e\+12, 1e\+12\]"),
        ({"unit": "a\nb"}, r"unit = 'a\\nb' must be one line of text"),
        ({"name": "a\tb"}, r"name = 'a\\tb' must be one line of text"),
    ],
)
def test_what_is_no_loop_is_refused(members: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Loop(**{"angle": [0.0, 1.0], "torque": [0.0, 1.0], "side": "input", "name": "a"} | members)
