"""Figures of single decisions, and episodes as films of them."""

from types import SimpleNamespace

import numpy as np
import pytest
from figure_checks import (
    GOAL,
    LINE,
    OBSTACLES,
    assert_inside,
    assert_labelled,
    lake,
    lake_tracks,
    legend_texts,
    texts_of,
)
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.collections import LineCollection
from PIL import Image
from property_draws import examples

from usvjax.errors import BadInputError
from usvjax.missions.dwa import decision
from usvjax.plots import style
from usvjax.plots.film import frame_steps, write_film
from usvkernels.status import Status


def fake_decide(state):
    """A window of 3 x 4 candidates: straight paths of three points, one inadmissible."""
    v, w = state[3] + 0.1 * np.arange(3), state[4] + 0.1 * np.arange(-2, 2)
    reach = np.arange(3)[:, None] * np.ones(2)
    paths = state[:2] + reach * (v[:, None] + w)[..., None, None]
    score = np.arange(12.0).reshape(3, 4)
    admissible = np.ones((3, 4), bool)
    admissible[2, 3] = False
    score[2, 3] = -np.inf
    return SimpleNamespace(v=v, w=w, paths=paths, admissible=admissible, score=score, chosen=(2, 2))


def fake_braking(state):
    decision = fake_decide(state)
    nowhere = np.zeros((3, 4), bool)
    return SimpleNamespace(**{**vars(decision), "admissible": nowhere, "chosen": None})


def episode(**changes):
    states = LINE.copy()
    states[:, 3] = 0.5
    arguments = {
        "trajectory": states,
        "goal": GOAL,
        "obstacles": OBSTACLES,
        "radius": 0.5,
        "goal_tolerance": 0.5,
        "status": Status.REACHED,
        "title": "improved, job 3",
    }
    return decision.Episode(**{**arguments, **changes})


def test_a_decision_shows_the_fan_by_score_and_the_window():
    film = decision.decision_film(episode(), fake_decide)
    film.show(10)
    fig = film.fig
    whole, near, window = fig.axes[:3]
    assert whole.get_aspect() == near.get_aspect() == 1.0
    for ax in (whole, window):
        assert_labelled(ax)
    assert near.get_title() == "close-up, 4 m wide"
    for ax in (whole, near):
        bad, good = (c for c in ax.collections if isinstance(c, LineCollection))
        assert len(bad.get_segments()) == 1
        assert len(good.get_segments()) == 11
        assert len({tuple(colour) for colour in good.get_colors()}) == 11
    (cells,) = window.images
    assert cells.get_array().shape == (3, 4, 4)
    np.testing.assert_allclose(cells.get_array()[2, 3], style.mpl.colors.to_rgba("#D9D9D9"))
    (mark,) = window.patches
    assert mark.get_xy() == (1.5, 1.5)
    assert fig.get_suptitle() == "improved, job 3\nt = 1.0 s,  v = +0.50 m/s,  w =  0.00 rad/s"
    assert "inadmissible candidates" in legend_texts(fig)
    np.testing.assert_allclose(np.mean(near.get_xlim()), LINE[10, 0])
    assert_inside(fig)


def test_braking_and_the_end_are_said():
    view = decision.EpisodeView(episode(), fake_braking)
    assert "no admissible candidate" in view.fig.get_suptitle()
    assert len(view.window.patches) == 0
    view.show(len(LINE) - 1)
    assert view.fig.get_suptitle().endswith("reached")


def test_an_episode_ends_with_its_steps_or_its_padding():
    padded = np.vstack([LINE, np.full((5, 5), np.nan)])
    assert len(decision.EpisodeView(episode(trajectory=padded), fake_decide).states) == 41
    assert len(decision.EpisodeView(episode(steps=7), fake_decide).states) == 8


def test_a_decision_on_a_chart_draws_the_land():
    grid = lake()
    track = lake_tracks(1)[0]
    shown = episode(trajectory=track, goal=(8000, 7000), obstacles=np.empty((0, 2)), grid_map=grid)
    view = decision.EpisodeView(shown, fake_decide)
    assert len(view.map.images) == len(view.near.images) == 1
    assert "Shore: X, L" in texts_of(view.map)
    assert view.map.get_xlabel() == "x, east (km)"
    assert_inside(view.fig)


@examples(100)
@given(st.integers(1, 5000), st.integers(1, 200))
def test_frames_are_few_even_and_include_both_ends_or_one_the_last(states, most):
    steps = frame_steps(states, most)
    assert steps[0] == (0 if most > 1 else states - 1)
    assert steps[-1] == states - 1
    assert len(steps) <= most
    gaps = np.diff(steps)
    assert (gaps > 0).all()
    assert len(set(gaps[:-1].tolist())) <= 1


def test_an_animation_is_a_looping_gif(tmp_path):
    calls = []
    path = write_film(
        decision.decision_film(episode(), fake_decide),
        tmp_path / "new" / "episode.gif",
        max_frames=4,
        dpi=60,
        progress=lambda done, total: calls.append((done, total)),
    )
    with Image.open(path) as image:
        assert image.n_frames == 4
        assert image.info["loop"] == 0
        assert image.width == pytest.approx(170 / 25.4 * 60, abs=1)
    assert calls == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [p.name for p in path.parent.iterdir()] == ["episode.gif"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"path": "a.avi"}, "suffix '.avi' is not one of .gif, .mp4"),
        ({"max_frames": 0}, "max_frames is 0"),
        ({"fps": 0}, "fps is 0"),
        ({"dpi": 0}, "dpi is 0"),
        ({"episode": episode(trajectory=LINE[:, :3])}, "trajectory has shape"),
        ({"episode": episode(trajectory=LINE * np.nan)}, "no finite position"),
    ],
)
def test_an_animation_refuses_and_writes_nothing(tmp_path, monkeypatch, changes, message):
    monkeypatch.chdir(tmp_path)
    arguments = {"episode": episode(), "decide": fake_decide, "path": "a.gif"}
    given = {**arguments, **changes}

    def write() -> None:
        write_film(decision.decision_film(given.pop("episode"), given.pop("decide")), **given)

    with pytest.raises(BadInputError, match=message):
        write()
    assert not list(tmp_path.iterdir())


def test_mp4_without_ffmpeg_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr("usvjax.plots.film.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(BadInputError, match="needs ffmpeg"):
        write_film(decision.decision_film(episode(), fake_decide), tmp_path / "a.mp4")


def test_a_step_that_is_not_there_is_refused():
    film = decision.decision_film(episode(), fake_decide)
    with pytest.raises(BadInputError, match="step is 41; 0 to 40"):
        film.show(41)
