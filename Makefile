# `make run` and `make test` need only make and Python >= 3.11; everything else goes into $(VENV).
#   make run PYTHON=python3.12        another interpreter
#   make run VENV=/some/where         another virtual environment
#   make mutants MUTANTS="audit arm"  those of the small wrong changes whose names hold one of these words
#   make bench BENCH=--quick          a short look; BENCH="validity step" runs these parts alone

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
RUNNABLE := $(VENV)/.runnable
TESTABLE := $(VENV)/.testable
WRITABLE := $(VENV)/.writable

.PHONY: run test mutants faults fuzz bench lint docs lock bundle clean

run: $(RUNNABLE)
	$(BIN)/suite run --planners temporal,rrt,pf

test: $(TESTABLE)
	$(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder --durations 15

mutants: $(TESTABLE)
	$(BIN)/python -m tests.mutants $(MUTANTS)

faults: $(TESTABLE)
	$(BIN)/python -m tests.faults

fuzz: $(TESTABLE)
	$(BIN)/python -m tests.fuzz

bench: $(TESTABLE)
	$(BIN)/python -m benchmarks $(BENCH)

lint: $(TESTABLE)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# The site, in build/site; a warning is an error.
docs: $(WRITABLE)
	$(BIN)/python docs/site.py
	$(BIN)/zensical build --clean --strict

# Made again only when what is to be installed has changed.
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check

$(RUNNABLE): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || \
	    { echo "error: $(PYTHON) is missing or older than Python 3.11; try: make PYTHON=/path/to/a/newer/python3" >&2; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	$(PIP_INSTALL) --requirement requirements.lock
	$(PIP_INSTALL) --no-deps --editable .
	@touch $@

# Linters and test tools on top.
$(TESTABLE): requirements-dev.lock $(RUNNABLE)
	$(PIP_INSTALL) --requirement requirements-dev.lock
	@touch $@

# What makes the site.
$(WRITABLE): requirements-docs.lock $(RUNNABLE)
	$(PIP_INSTALL) --requirement requirements-docs.lock
	@touch $@

# Pins from pyproject.toml for every Python >= 3.11; needs uv. All files have the same versions: with every extra, with
# what tests and linters need, with what the site needs, and with what a run needs.
UV_COMPILE := uv pip compile pyproject.toml --quiet --universal --python-version 3.11 --generate-hashes \
    --no-annotate --custom-compile-command "make lock" --upgrade

lock:
	$(UV_COMPILE) --all-extras --output-file requirements-all.lock
	$(UV_COMPILE) --extra test --extra dev --extra cluster --constraint requirements-all.lock --output-file requirements-dev.lock
	$(UV_COMPILE) --extra docs --constraint requirements-all.lock --output-file requirements-docs.lock
	$(UV_COMPILE) --constraint requirements-all.lock --output-file requirements.lock

# The script of replays and reports from web/, with three.js in it; needs node. What it makes is committed.
bundle:
	cd web && npm ci --no-audit --no-fund --omit-lockfile-registry-resolved && npm run bundle

clean:
	rm -rf $(VENV)
