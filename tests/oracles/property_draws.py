"""How many cases a property test draws: with USVJAX_FUZZ set ten times as many, new each time."""

import os

from hypothesis import settings

FUZZ = bool(os.environ.get("USVJAX_FUZZ"))


def examples(count: int) -> settings:
    """Decorates a property test that draws so many cases; what else holds says the profile."""
    return settings(max_examples=10 * count if FUZZ else count)
