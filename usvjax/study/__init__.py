"""Studies: a TOML file becomes shards of Parquet, a manifest and a summary.

`run_study` is what `usvjax study` calls; `load_run` reads a run back.
"""

from usvjax.study.reader import Run, load_run
from usvjax.study.spec import Condition, StudySpec, load_spec, parse_spec
from usvjax.study.study import StudyResult, run_study

__all__ = [
    "Condition",
    "Run",
    "StudyResult",
    "StudySpec",
    "load_run",
    "load_spec",
    "parse_spec",
    "run_study",
]
