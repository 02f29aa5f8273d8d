"""The experiments of the papers: every table and figure, regenerated beside the published values.

One package per paper; run it with ``usvjax reproduce PAPER`` or ``python -m experiments.PAPER``.
"""
