"""Films, GIF or MP4."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from usvjax.errors import BadInputError
from usvjax.plots import style

SUFFIXES = (".gif", ".mp4")


def write_film(fig: Figure, frames: Iterator[None], path: Path, *, fps: int, dpi: int) -> Path:
    """Write a film of a figure, whole or not at all.

    Args:
        fig: The figure.
        frames: Each step changes the figure to the next frame.
        path: File to write: .gif, or .mp4 where ffmpeg is installed.
        fps: Frames per second.
        dpi: Dots per inch.

    Returns:
        The path written.

    Raises:
        BadInputError: A place that cannot be written.
    """
    fig.set_dpi(dpi)
    write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
    return style.write_atomically(path, lambda file: write(fig, frames, file, fps))


def check_animation(path: Path, *, max_frames: int, fps: int) -> None:
    """Raise BadInputError, before anything is computed, for what a film cannot be made of."""
    style.check_suffix(path, SUFFIXES)
    for name, value in (("max_frames", max_frames), ("fps", fps)):
        if value < 1:
            raise BadInputError(f"{name} is {value}; at least 1 was wanted")
    if path.suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise BadInputError(f"{path}: an .mp4 needs ffmpeg, which is not installed; use .gif")


def _write_gif(fig: Figure, frames: Iterator[None], path: Path, fps: int) -> None:
    """Write a looping GIF; quicker than matplotlib's writer, which draws every frame twice."""
    canvas = FigureCanvasAgg(fig)
    images = []
    for _ in frames:
        canvas.draw()
        image = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        # As palette images at once: a tenth of the memory while the frames are collected.
        images.append(image.quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE))
    images[0].save(path, save_all=True, append_images=images[1:], duration=1000 // fps, loop=0)


def _write_mp4(fig: Figure, frames: Iterator[None], path: Path, fps: int) -> None:
    writer = FFMpegWriter(fps)
    with writer.saving(fig, str(path), fig.dpi):
        for _ in frames:
            writer.grab_frame()


def frame_steps(states: int, max_frames: int) -> list[int]:
    """Return the steps to show: evenly spaced, the first and the last among them; one, the last."""
    if max_frames == 1:
        return [states - 1]
    every = max(1, math.ceil((states - 1) / (max_frames - 1)))
    return sorted({*range(0, states, every), states - 1})
