# Two commands do all the set-up on a fresh machine: `make study` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: study test fuzz lint bench clean

study: $(VENV)/.installed  ## install, then run the main job: table, figures, paths
	$(BIN)/usvjax study studies/tan2022.toml

test: $(VENV)/.tools  ## install, then run the tests
	$(BIN)/python -m pytest --numprocesses auto --dist loadfile --max-worker-restart 0

fuzz: $(VENV)/.tools  ## the tests again, their properties on ten times as many new cases
	USVJAX_FUZZ=1 $(BIN)/python -m pytest --numprocesses auto --dist loadfile --max-worker-restart 0

lint: $(VENV)/.tools  ## linter, formatter and type checker
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(VENV)/.tools  ## all comparisons with peers; rewrites benchmarks/RESULTS.md
	$(BIN)/python -m benchmarks

clean:  ## remove the environment and every run
	rm -rf $(VENV) runs

$(VENV)/.installed: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

$(VENV)/.tools: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@ $(VENV)/.installed
