"""The comparison of tours with peers: python-tsp takes part only where it is installed."""

import importlib.util
import json
import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from benchmarks import tour_peers

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "tour_peers.json"


def solvers(monkeypatch, installed):
    with monkeypatch.context() as patch:
        patch.setattr(importlib.util, "find_spec", lambda name: installed or None)
        return runpy.run_path(str(ROOT / "benchmarks" / "peers" / "tours.py"))["SOLVERS"]


def test_python_tsp_is_left_out_where_it_is_missing(monkeypatch):
    assert list(solvers(monkeypatch, False)) == [
        "LKH (elkai, C)",
        "scikit-opt, GA_TSP",
        "scikit-opt, ACA_TSP",
    ]
    assert set(solvers(monkeypatch, True)) == set(tour_peers.MOST)


class Crew:
    """One that needs no processes, and knows only its own."""

    def __init__(self, cores):
        self.known = tour_peers.SOLVERS

    def run(self, name, tables):
        assert name in self.known
        return 1.0, [9.0] * len(tables)

    def close(self):
        pass


def test_the_comparison_asks_only_those_that_are_there(monkeypatch):
    monkeypatch.setattr(tour_peers, "SOLVERS", solvers(monkeypatch, False))
    monkeypatch.setattr(tour_peers, "OURS", {"recommended": 64})
    monkeypatch.setattr(tour_peers, "Crew", Crew)
    lengths = SimpleNamespace(length=np.full(64, 9.0))
    monkeypatch.setattr(tour_peers, "solve_tour", lambda *_, **__: lengths)
    found = tour_peers.measure(quick=True)
    assert list(found["rates"]) == ["recommended", *tour_peers.SOLVERS]
    assert "python-tsp" not in tour_peers.report(found)


def test_a_record_reads_the_same_where_a_peer_is_missing(monkeypatch):
    found = json.loads(RESULTS.read_text())["found"]
    page = tour_peers.report(found)
    monkeypatch.setattr(tour_peers, "SOLVERS", {})
    assert tour_peers.report(found) == page
    assert "| python-tsp, 2-opt |" in page
