"""One episode as a film of its decisions."""

from collections.abc import Callable, Iterator
from pathlib import Path

from usvjax.errors import BadInputError
from usvjax.missions.dwa.decision import Decide, Episode, EpisodeView
from usvjax.plots import style
from usvjax.plots.film import check_animation, frame_steps, write_film


@style.styled
def animate_episode(
    episode: Episode,
    decide: Decide,
    path: str | Path,
    *,
    max_frames: int = 120,
    fps: int = 12,
    dpi: int = 110,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Write an episode with its dynamic window as GIF or MP4, whole or not at all.

    Args:
        episode: What to show.
        decide: From a state to the decision taken there.
        path: File to write: .gif, or .mp4 where ffmpeg is installed.
        max_frames: Frames at most; steps between them are skipped evenly.
        fps: Frames per second.
        dpi: Dots per inch.
        progress: Called with (frames done, frames in all) after every frame.

    Returns:
        The path written.

    Raises:
        BadInputError: Another suffix, no ffmpeg for an .mp4, max_frames, fps or dpi below 1,
            a bad trajectory, or a place that cannot be written.
    """
    target = Path(path)
    check_animation(target, max_frames=max_frames, fps=fps)
    if dpi < 1:
        raise BadInputError(f"dpi is {dpi}; at least 1 was wanted")
    view = EpisodeView(episode, decide)
    steps = frame_steps(len(view.states), max_frames)

    def frames() -> Iterator[None]:
        for done, step in enumerate(steps, start=1):
            view.show(step)
            yield
            if progress is not None:
                progress(done, len(steps))

    return write_film(view.fig, frames(), target, fps=fps, dpi=dpi)
