"""What the results on Tan et al. 2022 come to, in sentences made from the numbers."""

from typing import Any


def summary(found: dict[str, Any]) -> list[str]:
    return ["x"]


def why(found: dict[str, Any]) -> list[str]:
    return ["y"]
