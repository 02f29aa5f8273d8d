"""Films, GIF or MP4."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from usvjax.errors import BadInputError
from usvjax.pictures import check_dpi, check_suffix
from usvjax.plots import style

SUFFIXES = (".gif", ".mp4")
DPI = 110


@dataclass(frozen=True)
class Film:
    """A figure that can show any of some steps.

    Attributes:
        fig: the figure.
        steps: how many there are.
        show: changes the figure to step 0 .. steps - 1.
    """

    fig: Figure
    steps: int
    show: Callable[[int], None]


def write_film(
    film: Film,
    path: str | Path,
    *,
    max_frames: int = 120,
    fps: int = 12,
    dpi: int = DPI,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Write a film as GIF or MP4, whole or not at all.

    Args:
        film: what to show.
        path: file to write: .gif, or .mp4 where ffmpeg is installed.
        max_frames: frames at most; steps between them are skipped evenly.
        fps: frames per second.
        dpi: dots per inch, 20 to 1200.
        progress: called with (frames done, frames in all) after every frame.

    Returns:
        The path written.

    Raises:
        BadInputError: another suffix, no ffmpeg for an .mp4, max_frames or fps below 1, another
            dpi, or a place that cannot be written.
    """
    target = Path(path)
    check_animation(target, max_frames=max_frames, fps=fps, dpi=dpi)
    steps = frame_steps(film.steps, max_frames)

    def frames() -> Iterator[None]:
        for done, step in enumerate(steps, start=1):
            film.show(step)
            yield
            if progress is not None:
                progress(done, len(steps))

    film.fig.set_dpi(dpi)
    write = _write_gif if target.suffix.lower() == ".gif" else _write_mp4
    return style.write_atomically(target, lambda file: write(film.fig, frames(), file, fps))


def check_animation(path: Path, *, max_frames: int, fps: int, dpi: int = DPI) -> None:
    """Raise BadInputError, before anything is computed, for what `write_film` refuses."""
    check_suffix(path, SUFFIXES)
    check_dpi("dpi", dpi)
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
