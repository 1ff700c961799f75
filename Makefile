# detumble: everything a person types begins here. `make help` lists it.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory --no-builtin-rules

# The project has an environment of its own: one that happens to be active has no say in it.
unexport VIRTUAL_ENV CONDA_PREFIX CONDA_DEFAULT_ENV PYTHONPATH PYTHONHOME

PY := .venv/bin/python
UV := .tools/bin/uv
ENV_READY := .venv/.env-ready
CORE_READY := .venv/.core-ready
# Folders count too: their time moves when a file is added or taken away.
RUST := Cargo.toml $(wildcard Cargo.lock rust-toolchain.toml) pyproject.toml \
	$(shell find crates \( -name '*.rs' -o -name '*.toml' -o -type d \) -not -path '*/target*')
PYTHON_SOURCES := python tests scripts benchmarks study

.PHONY: help setup paper study test lint format lock clean

help: ## this list
	@grep -hE '^[a-z]+:.*## ' Makefile | sed -E 's/^([a-z]+):.*## /  make \1\t/' | expand -t 16

setup: $(CORE_READY) ## the environment in .venv, with the compiled core
	@:

$(UV): requirements-tools.lock
	@scripts/python-for-detumble -c ""
	@echo "setup: making the environment in .venv"
	@scripts/python-for-detumble -m venv --clear .tools || { echo "setup: python's venv module does not work here (Debian: install python3-venv)" >&2; exit 1; }
	@.tools/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-tools.lock
	@touch $@

$(ENV_READY): requirements.lock $(UV)
	@test -x $(PY) || $(UV) venv --quiet --python "$$(scripts/python-for-detumble -c 'import sys; print(sys.executable)')" .venv
	@$(UV) pip sync --quiet --python $(PY) --require-hashes requirements.lock
	@touch $@

$(CORE_READY): $(ENV_READY) $(RUST)
	@command -v cargo >/dev/null || { echo "setup: cargo is missing; Rust is installed with rustup (or your system's rustup package)" >&2; exit 1; }
	@echo "setup: building the core (about a minute the first time)"
	@VIRTUAL_ENV="$$PWD/.venv" PATH="$$PWD/.tools/bin:$$PATH" \
		.venv/bin/maturin develop --uv --release --locked --quiet >.venv/core.log 2>&1 || { cat .venv/core.log >&2; exit 1; }
	@touch $@

paper: setup ## the paper's five captures: table on screen, figures in results/paper
	@.venv/bin/detumble paper --out results/paper

study: setup ## which law is best after equal tuning: docs/study made anew, about half an hour
	@$(PY) -m study

test: setup ## every test, Rust and Python
	cargo test --workspace --exclude detumble-python --locked --quiet
	$(PY) -m pytest -n auto --maxprocesses 4 --dist worksteal

lint: setup ## formatting, lints, types and the order of imports
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked --quiet -- -D warnings
	.venv/bin/ruff check $(PYTHON_SOURCES)
	.venv/bin/ruff format --check $(PYTHON_SOURCES)
	.venv/bin/mypy
	.venv/bin/lint-imports --no-cache --no-logo

format: setup ## put all sources in the project's format
	cargo fmt --all
	.venv/bin/ruff check --fix-only --quiet $(PYTHON_SOURCES)
	.venv/bin/ruff format $(PYTHON_SOURCES)

LOCK := $(UV) pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-header
lock: $(UV) ## pin the dependencies anew
	$(LOCK) --upgrade --extra dev pyproject.toml -o requirements.lock
	$(LOCK) requirements-tools.in -o requirements-tools.lock

clean: ## take away everything that was built
	rm -rf .venv .tools target results .mypy_cache .ruff_cache benchmarks/peers/.venv
	find python -name '_core*.so' -o -name '_core*.pyd' | xargs rm -f
	find python tests -name __pycache__ -prune -exec rm -rf {} +
