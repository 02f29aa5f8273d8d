"""What the planners are made of, each part against a plain reckoning of its own."""

from collections import Counter
from functools import partial
from itertools import pairwise
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from grid_oracle import check_path
from scipy.stats import chisquare

from usvjax.devices import QUICKLY_COMPILED
from usvjax.planners.rows import _moves
from usvkernels.draws import seeds
from usvkernels.planners import aco, ants, cmpso, ga, rows
from usvkernels.planners.moves import MOVES

SIDE = 7
STATIC = ants.AcoStatic(SIDE, SIDE, ants=3000, iterations=1, max_steps=48, queries=1, lanes=256)
WALL = np.zeros((SIDE, SIDE), bool)
WALL[2, 2] = WALL[4, 5] = True
START, GOAL = (3, 3), (6, 2)


def place_of(cell: tuple[int, int]) -> int:
    return (cell[1] + 1) * STATIC.stride + cell[0] + 1


def cell_of(place: int) -> tuple[int, int]:
    return place % STATIC.stride - 1, place // STATIC.stride - 1


def is_open(cell: tuple[int, int], move: tuple[int, int]) -> bool:
    beside = [(cell[0] + dx, cell[1] + dy) for dx, dy in (move, (move[0], 0), (0, move[1]))]
    return all(0 <= x < SIDE and 0 <= y < SIDE and not WALL[y, x] for x, y in beside)


@pytest.fixture(scope="module")
def colony() -> dict[str, Any]:
    """The walks of many ants on a field of pheromone, and what they leave."""
    queries = ants.AcoQueries(
        blocked=jnp.asarray(WALL[None]),
        start=jnp.array([place_of(START)]),
        goal=jnp.array([place_of(GOAL)]),
        seed=seeds(jax.random.key(3), 1),
    )
    pheromone = np.random.default_rng(4).uniform(0.2, 2.0, (STATIC.size, 8)).astype(np.float32)

    @partial(jax.jit, compiler_options=QUICKLY_COMPILED)
    def walk(queries: ants.AcoQueries) -> tuple[ants.Walk, jax.Array, jax.Array]:
        weight = pheromone * aco._attraction(STATIC, aco.AcoParams(), queries, jnp.float32)
        record = jnp.zeros(STATIC.rows * STATIC.lanes, jnp.int32)
        walked = ants.walked(STATIC, queries, jnp.int32(1), jnp.int32(5), weight, record)
        length = aco._lengths(STATIC, walked, jnp.float32)
        return walked, length, aco._deposits(STATIC, walked, length)

    with jax.default_device(jax.local_devices()[0]):
        walked, length, deposits = jax.device_get(walk(queries))
    record = walked.log.record.reshape(STATIC.rows, STATIC.lanes)
    steps, _, began, slot = walked.ends.T
    routes = []
    for ant in range(STATIC.ants):
        edges = record[began[ant] : began[ant] + max(steps[ant], 2), slot[ant]]
        routes.append([(cell_of(edge >> 3), int(edge & 7)) for edge in edges.tolist()])
    return {
        "pheromone": pheromone,
        "steps": steps,
        "routes": routes,
        "length": length[:, 0],
        "deposits": deposits,
    }


def chances(pheromone: np.ndarray, cell: tuple[int, int], been: set[tuple[int, int]]) -> np.ndarray:
    """Probability of each move by the formula."""
    weight = np.zeros(8)
    for k, (dx, dy) in enumerate(MOVES):
        there = cell[0] + dx, cell[1] + dy
        if is_open(cell, (dx, dy)) and there not in been:
            distance = max(np.hypot(there[0] - GOAL[0], there[1] - GOAL[1]), aco.AT_GOAL)
            weight[k] = pheromone[place_of(cell), k] * (1 / distance) ** 5
    return weight / weight.sum()


def test_ants_choose_by_pheromone_and_nearness_and_never_return(colony: dict[str, Any]) -> None:
    first = Counter(route[0][1] for route in colony["routes"])
    then = {k: Counter(r[1][1] for r in colony["routes"] if r[0][1] == k) for k in first}
    assert {route[0][0] for route in colony["routes"]} == {START}
    cases = [(START, {START}, first)]
    for k, counts in then.items():
        there = START[0] + MOVES[k][0], START[1] + MOVES[k][1]
        cases.append((there, {START, there}, counts))
    tested = 0
    for cell, been, counts in cases:
        expected = chances(colony["pheromone"], cell, been)
        assert all(expected[k] > 0 for k in counts)
        likely = expected * counts.total() >= 5
        if likely.sum() < 2:
            continue
        seen = np.array([counts[k] for k in range(8)])
        pooled = np.append(expected[likely], expected[~likely].sum()) * counts.total()
        observed = np.append(seen[likely], seen[~likely].sum())
        if pooled[-1] < 1:
            pooled, observed = pooled[:-1] * observed[:-1].sum() / pooled[:-1].sum(), observed[:-1]
        assert chisquare(observed, pooled * observed.sum() / pooled.sum()).pvalue > 1e-4
        tested += 1
    assert tested >= 4


def test_ants_that_arrive_leave_pheromone_on_their_way(colony: dict[str, Any]) -> None:
    expected = np.zeros((STATIC.size, 8))
    arrived = np.flatnonzero(colony["steps"])
    assert 100 < len(arrived) < STATIC.ants  # and some are lost
    for ant in arrived:
        route = colony["routes"][ant]
        cells = [cell for cell, _ in route]
        cells.append((cells[-1][0] + MOVES[route[-1][1]][0], cells[-1][1] + MOVES[route[-1][1]][1]))
        assert cells[0] == START
        assert cells[-1] == GOAL
        assert len(set(cells)) == len(cells)
        length = check_path(WALL, np.array(cells))
        assert colony["length"][ant] == pytest.approx(length, rel=1e-6)
        for (x, y), (u, v) in pairwise(cells):
            expected[place_of((x, y)), MOVES.index((u - x, v - y))] += 1 / length
            expected[place_of((u, v)), MOVES.index((x - u, y - v))] += 1 / length
    assert np.isinf(colony["length"][colony["steps"] == 0]).all()
    np.testing.assert_allclose(colony["deposits"], expected, rtol=1e-4, atol=1e-3)


# --- rows -------------------------------------------------------------------------------------

MEMBERS, QUERIES, ROWS = 16, 40, 12


def random_queries(height: int = 9, width: int = 12) -> rows.RowQueries:
    rng = np.random.default_rng(6)
    blocked = rng.random((QUERIES, height, width)) < 0.2
    x, y = rng.integers(0, width, (2, QUERIES)), rng.integers(0, height, (2, QUERIES))
    x[1] = np.where((x[0] == x[1]) | (y[0] == y[1]), (x[0] + 3) % width, x[1])
    y[1] = np.where(y[0] == y[1], (y[0] + 2) % height, y[1])
    for i in range(2):
        blocked[np.arange(QUERIES), y[i], x[i]] = False
    start, goal = np.stack([x, y], axis=-1).astype(np.int32)
    across = rng.random(QUERIES) < 0.5
    seed = seeds(jax.random.key(1), QUERIES)
    return rows.RowQueries(*(jnp.asarray(a) for a in (blocked, start, goal, across, seed)))


@pytest.fixture(scope="module")
def threads() -> dict[str, Any]:
    """Paths of random wishes, what crossing and mutating makes of them, and their threads."""
    static = ga.GaStatic(ROWS, MEMBERS, 1)

    @partial(jax.jit, compiler_options=QUICKLY_COMPILED)
    def make(queries: rows.RowQueries, wish: jax.Array) -> dict[str, Any]:
        place = rows.frame(queries, ROWS, MEMBERS)
        exits, alive = rows.thread(place, wish)
        people = ga._Population(exits, alive, alive * 1.0, alive * 1.0)
        time = jnp.int32(3)
        always = ga.GaParams(crossover=1.0, mutation=1.0)
        never = ga.GaParams(crossover=0.0, mutation=0.0)
        crossed = ga._crossed(static, always, place, people, time)
        mutants, lives = ga._mutated(static, always, place, exits, alive, time)
        return {
            "exits": exits,
            "alive": alive,
            "measured": rows.measure(place, exits),
            "again": rows.thread(place, exits),
            "crossed": crossed,
            "crossed_again": rows.thread(place, crossed),
            "uncrossed": ga._crossed(static, never, place, people, time),
            "mutants": (mutants, lives),
            "mutants_again": rows.thread(place, mutants),
            "unchanged": ga._mutated(static, never, place, exits, alive, time)[0],
        }

    queries = random_queries()
    wish = np.random.default_rng(2).integers(-2, 14, (ROWS, QUERIES * MEMBERS)).astype(np.int32)
    with jax.default_device(jax.local_devices()[0]):
        return jax.device_get({"queries": queries, **make(queries, jnp.asarray(wish))})


def test_threads_are_paths_and_measured_right(threads: dict[str, Any]) -> None:
    queries, measured = threads["queries"], threads["measured"]
    for lane in np.flatnonzero(threads["alive"]):
        q = lane // MEMBERS
        moves = _moves(
            queries.start[q],
            queries.goal[q],
            bool(queries.across[q]),
            threads["exits"][:, lane],
            measured.joins[:, lane],
        )
        steps = np.array(MOVES)[moves]
        path = np.concatenate([queries.start[q][None], queries.start[q] + steps.cumsum(axis=0)])
        assert (path[-1] == queries.goal[q]).all()
        length = check_path(queries.blocked[q], path)
        straight, diagonal = measured.straight[lane], measured.diagonal[lane]
        assert straight + diagonal * np.sqrt(2) == pytest.approx(length)
        course = np.round(np.arctan2(steps[:, 1], steps[:, 0]) / (np.pi / 4)).astype(int)
        turn = np.abs(np.diff(course)) % 8
        turns = Counter(np.minimum(turn, 8 - turn).tolist())
        assert measured.turns[:, lane].tolist() == [turns[k] for k in (1, 2, 3, 4)]


def in_rows(queries: rows.RowQueries, q: int) -> bool:
    """Whether a path leads from start to goal that never turns back along the axis of the rows."""
    blocked, axis = queries.blocked[q], 0 if queries.across[q] else 1
    start, goal = queries.start[q].tolist(), queries.goal[q].tolist()
    sign = np.sign(goal[axis] - start[axis])
    reached, ahead = {tuple(start)}, [tuple(start)]
    while ahead:
        x, y = ahead.pop()
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            cell = (x + dx, y + dy)
            inside = 0 <= cell[0] < blocked.shape[1] and 0 <= cell[1] < blocked.shape[0]
            past = (cell[axis] - goal[axis]) * sign > 0 or (dx, dy)[axis] * sign < 0
            if inside and not past and cell not in reached and not blocked[cell[1], cell[0]]:
                reached.add(cell)
                ahead.append(cell)
    return tuple(goal) in reached


def test_threads_are_found_wherever_there_are_any(threads: dict[str, Any]) -> None:
    expected = [in_rows(threads["queries"], q) for q in range(QUERIES)]
    assert 0 < sum(expected) < QUERIES
    np.testing.assert_array_equal(threads["alive"], np.repeat(expected, MEMBERS))


def test_a_path_is_its_own_thread(threads: dict[str, Any]) -> None:
    alive = threads["alive"]
    for before, (again, arrives) in (
        (threads["exits"], threads["again"]),
        (threads["crossed"], threads["crossed_again"]),
    ):
        assert arrives[alive].all()
        np.testing.assert_array_equal(again[:, alive], before[:, alive])
    mutants, lives = threads["mutants"]
    np.testing.assert_array_equal(lives, alive)
    np.testing.assert_array_equal(threads["mutants_again"][0][:, lives], mutants[:, lives])
    assert threads["mutants_again"][1][lives].all()


def test_crossing_exchanges_the_ends_of_pairs(threads: dict[str, Any]) -> None:
    exits, crossed, alive = (threads[k] for k in ("exits", "crossed", "alive"))
    np.testing.assert_array_equal(threads["uncrossed"], exits)
    np.testing.assert_array_equal(threads["unchanged"][:, alive], exits[:, alive])
    both = alive[::2] & alive[1::2]
    own = (crossed[:, ::2] == exits[:, ::2]) & (crossed[:, 1::2] == exits[:, 1::2])
    swapped = (crossed[:, ::2] == exits[:, 1::2]) & (crossed[:, 1::2] == exits[:, ::2])
    assert (own | swapped).all()
    assert own[:, ~both].all()
    assert (~own).any(axis=0)[both].mean() > 0.3
    # Rows of their own first, then rows of the other's: no return.
    tail = np.logical_or.accumulate(~own, axis=0)
    assert (swapped | ~tail).all()


def bare_frame(n: Any, first: Any, last: Any, seed: Any) -> rows.Frame:
    """Lanes without a map."""
    n, first, last = (jnp.asarray(a, jnp.int32) for a in (n, first, last))
    zero = jnp.zeros_like(n)
    return rows.Frame(zero, zero, zero, n, first, last, zero + 12, seed, side=12)


def test_the_wheel_draws_in_proportion_to_fitness() -> None:
    static = ga.GaStatic(1, 4, 1)
    fitness = jnp.tile(jnp.array([1.0, 0.0, 3.0, 4.0]), 4000)
    lanes = jnp.arange(16000, dtype=jnp.int32)
    zero = jnp.zeros_like(lanes)
    place = bare_frame(zero, zero, zero, jnp.repeat(seeds(jax.random.key(2), 4000), 4, axis=1))
    people = ga._Population(lanes[None], fitness > 0, fitness, fitness)
    with jax.default_device(jax.local_devices()[0]):
        drawn = np.asarray(jax.jit(partial(ga._selected, static, place))(people, 1).exits[0])
    assert (drawn // 4 == np.arange(16000) // 4).all()  # each query from its own
    counts = np.bincount(drawn % 4, minlength=4)
    assert counts[1] == 0
    assert chisquare(counts[[0, 2, 3]], 2000.0 * np.array([1, 3, 4])).pvalue > 1e-4


def test_particles_are_lines_through_way_points() -> None:
    static = cmpso.CmpsoStatic(ROWS, MEMBERS, 1)
    rng, lanes = np.random.default_rng(8), 100
    n, first, last = rng.integers([[1], [0], [0]], ROWS, (3, lanes))
    x = rng.uniform(0, 12, (static.waypoints, lanes)).astype(np.float32)
    place = bare_frame(n, first, last, jnp.zeros((2, lanes), jnp.uint32))
    got = np.asarray(jax.jit(partial(cmpso._lines, static, place))(jnp.asarray(x)))
    knots = np.concatenate([first[None] + 0.5, np.floor(x * 256) / 256, last[None] + 0.5])
    for lane in range(lanes):
        at = np.arange(static.waypoints + 2) * n[lane] / (static.waypoints + 1)
        column = np.interp(np.arange(1, n[lane] + 1), at, knots[:, lane])
        clear = np.abs(column - np.round(column)) > 1e-9
        wanted = np.floor(column)
        assert (got[: n[lane], lane] == wanted)[clear].all()
        assert got[n[lane] - 1, lane] == last[lane]
