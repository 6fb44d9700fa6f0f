# Two commands: make demo, make test. Each does all set-up by itself, once.
.DEFAULT_GOAL := help
.PHONY: help setup demo bench test test-slow lint format clean
PY := .venv/bin/python

help:  ## what there is
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/' | expand -t 14

.venv/.ready: pyproject.toml constraints.txt tools/setup.sh
	@tools/setup.sh

setup: .venv/.ready  ## virtual environment and system libraries

demo: .venv/.ready  ## empty a simulated bin, from images; writes out/demo/report.html
	@$(PY) -m cell demo $(ARGS)

bench: .venv/.ready  ## every bench, with the machine the figures came from
	@$(PY) -m cell bench all $(ARGS)

lint: .venv/.ready  ## format, lint, types, import contracts
	@.venv/bin/ruff format --check .
	@.venv/bin/ruff check .
	@.venv/bin/mypy
	@.venv/bin/lint-imports --no-logo 2>/dev/null || .venv/bin/lint-imports

test: lint  ## everything CI runs
	@$(PY) -m pytest -n 2 $(ARGS)

test-slow: .venv/.ready  ## the long ones
	@$(PY) -m pytest -m slow $(ARGS)

format: .venv/.ready  ## write the house format
	@.venv/bin/ruff format .
	@.venv/bin/ruff check --fix .

clean:  ## remove what was built
	rm -rf .venv out .mypy_cache .ruff_cache .pytest_cache .hypothesis
