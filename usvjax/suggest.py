"""The second half of a sentence about an unknown name: which one was meant."""

import difflib
from collections.abc import Iterable

_LONGEST = 100
"""Characters of what was given that are compared; no name is as long."""


def did_you_mean(given: str, valid: Iterable[str]) -> str:
    """Say which valid name is nearest to `given`, or list them when none is near.

    Args:
        given: what the user wrote.
        valid: the names that would have been right.

    Returns:
        Such as "did you mean 'radius'?".
    """
    names = sorted(set(valid))
    folded = {name.lower(): name for name in names}
    near = difflib.get_close_matches(given[:_LONGEST].lower(), folded, n=1, cutoff=0.5)
    if near:
        return f"did you mean {folded[near[0]]!r}?"
    return f"valid: {', '.join(names)}" if names else "no name is valid here"
