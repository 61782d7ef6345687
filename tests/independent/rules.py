# SPDX-License-Identifier: GPL-3.0-or-later
"""What the parts of the independent reader share."""

NONE = 0xFFFFFFFF
INFINITE = 0x7F7FFFFF  # the bits of the largest finite f32


class Invalid(Exception):
    """The file breaks a rule."""


class Unsupported(Exception):
    """The file asks for something that this reader does not do."""


def check(holds, place, why="breaks its rule"):
    if not holds:
        raise Invalid(f"{place}: {why}")
