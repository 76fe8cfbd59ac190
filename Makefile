# `make run` and `make test` do all the set-up themselves; see CONTRIBUTING.md.
#
#   make run ARGS="head.nrrd"          open a file
#   make test ARGS="-m unit -x"        arguments for pytest (without any: all but the slow tests, in two processes)
#   make run PYTHON=python3.13         choose the interpreter (3.11 to 3.14)

PYTHON ?= $(shell sh scripts/find_python.sh)
VENV := .venv
BIN := $(VENV)/bin
# All tests run in two processes, each file in one of them; each process has a virtual screen of its own. The
# layers keep their order, so that mistakes in plain values show first.
ALL_TESTS := --numprocesses 2 --dist loadfile --no-loadscope-reorder
MOST_TESTS := $(ALL_TESTS) -m "not slow"
MAKEFLAGS += --no-print-directory

.DEFAULT_GOAL := help
.PHONY: help run test test-all warm-up lint format check bench build clean distclean python

help:
	@echo "make run        open the program (without a display: draw the sample into out/)"
	@echo "make test       run the tests, without those marked slow"
	@echo "make test-all   run all tests"
	@echo "make warm-up    compile the kernels ahead"
	@echo "make check      ruff, mypy, import-linter, codespell"
	@echo "make lint       ruff alone"
	@echo "make format     let ruff rewrite the layout of the code"
	@echo "make bench      run the benchmarks among the tests"
	@echo "make build      wheel and source archive into dist/"
	@echo "make clean      remove caches, builds and out/ (distclean: .venv too)"

python:
	@test -n "$(PYTHON)" || { \
	  echo "VolViz needs Python 3.11 to 3.14, and none of python3, python3.11 ... python3.14 is one." >&2; \
	  echo "Debian 12 and Ubuntu 24.04: apt-get install python3. Others: python.org, then make PYTHON=/path/to/python" >&2; \
	  exit 2; }

run: python
	@$(PYTHON) scripts/run.py $(ARGS)

test: python
	@$(PYTHON) scripts/set_up.py --for test
	@$(BIN)/python -m pytest $(or $(ARGS),$(MOST_TESTS))

test-all: python
	@$(PYTHON) scripts/set_up.py --for test
	@$(BIN)/python -m pytest $(ALL_TESTS)

warm-up: python
	@$(PYTHON) scripts/set_up.py --for test
	@$(BIN)/python -m volviz.kernels.warm_up

lint: python
	@$(PYTHON) scripts/set_up.py --for check
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .

format: python
	@$(PYTHON) scripts/set_up.py --for check
	@$(BIN)/ruff check --fix-only --quiet .
	@$(BIN)/ruff format .

check: lint
	@$(BIN)/mypy
	@$(BIN)/lint-imports
	@$(BIN)/codespell

bench: python
	@$(PYTHON) scripts/set_up.py --for test
	@$(BIN)/python -m pytest --benchmark-enable --benchmark-only $(ARGS)

build: python
	@$(PYTHON) scripts/set_up.py --for check
	@$(BIN)/python -m build

clean:
	rm -rf build dist out .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis .benchmarks
	find volviz ui tests scripts benchmarks -type d -name __pycache__ -prune -exec rm -rf {} + 2>/dev/null || true

distclean: clean
	rm -rf $(VENV)
