"""Angles on the host, in double precision; those of the kernels are in `usvkernels.trig`."""

import numpy as np


def wrapped(angle: np.ndarray) -> np.ndarray:
    """The same angles in [-pi, pi) (rad)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi
