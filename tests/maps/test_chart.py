"""A map that all jobs share."""

import numpy as np
import pytest
from route_ponds import pond

from usvjax.errors import BadInputError
from usvjax.maps import save_map
from usvjax.maps.chart import cells_where, inflated, map_digest, off_shore, read_chart


def test_a_file_beside_the_study_is_found_and_refined(tmp_path):
    save_map(pond(), tmp_path / "pond.map")
    grid, digest = read_chart("pond.map", None, 2, tmp_path, "s.toml")
    assert grid == pond().refined(2)
    assert digest == map_digest(pond().refined(2)) != map_digest(pond())


def test_the_digest_is_of_the_cells_and_not_of_the_file(tmp_path):
    for name in ("pond.map", "other.map"):
        save_map(pond(), tmp_path / name)
    first, second = (read_chart(n, None, 1, tmp_path, "s")[1] for n in ("pond.map", "other.map"))
    assert first == second


def test_packaged_maps_go_by_name(tmp_path):
    assert read_chart("hongze-1000", None, 1, tmp_path, "s.toml")[0].cell_size == 1000.0


@pytest.mark.parametrize(
    ("name", "refine", "words"),
    [
        ("pond.map", 0, "s.toml: 'refine' must be at least 1, got 0"),
        (
            "pond.map",
            10_000,
            "s.toml: 'pond.map' with 'refine' of 10000 has 180,000 x 140,000",
        ),
        ("lake.map", 1, r"s.toml: .*lake\.map"),
    ],
)
def test_maps_that_cannot_be_read_are_refused(tmp_path, name, refine, words):
    save_map(pond(), tmp_path / "pond.map")
    with pytest.raises(BadInputError, match=words):
        read_chart(name, None, refine, tmp_path, "s.toml")


def test_water_off_the_shore_is_that_which_inflation_leaves():
    grid = pond()
    assert inflated(grid, 0.0) is grid
    np.testing.assert_array_equal(off_shore(grid, 51.0), ~inflated(grid, 50.0).blocked)
    x, y = cells_where(off_shore(grid, 51.0)).T
    assert not grid.blocked[y, x].any()
    assert len(x) == off_shore(grid, 51.0).sum()
