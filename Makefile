# Needs python3 (3.11 or newer) and make; everything else goes into .venv.
PYTHON ?= python3
PYTEST = .venv/bin/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

.PHONY: walk demo proofcheck test quick bench docs lint clean
.DELETE_ON_ERROR:

# Train a gait for AMBER-3M, walk it in MuJoCo, prove it, and write all that into one page.
walk: .venv/run.stamp
	.venv/bin/neuralgaits train amber3m
	.venv/bin/neuralgaits simulate latest
	.venv/bin/neuralgaits certify latest
	.venv/bin/neuralgaits report latest

# Watch a gait that came with the package walk, without training: a live page.
demo: .venv/run.stamp
	.venv/bin/neuralgaits demo

# Build the independent proof checker, which needs g++ and nothing else: build/proofcheck FILE.
proofcheck: build/proofcheck

build/proofcheck: tools/proofcheck/proofcheck.cpp $(wildcard tools/proofcheck/*.hpp)
	@mkdir -p build
	$(CXX) -std=c++17 -O1 -frounding-math -ffp-contract=off -pthread -Wall -Wextra -Werror $< -o $@

test: .venv/dev.stamp
	$(PYTEST)

# All but the tests marked as slow.
quick: .venv/dev.stamp
	$(PYTEST) -m "not slow"

# Print the figures the tests do not assert: times, rates, long walks. Altered inputs and kills are
# few here; INPUTS=100000 KILLS=200 make bench takes an hour more.
bench: .venv/dev.stamp
	@for script in benchmarks/*.py; do echo "== $$script"; INPUTS=$${INPUTS:-2000} KILLS=$${KILLS:-14} .venv/bin/python $$script || exit 1; done

# The pages, for a browser: build/docs/index.html. A warning is an error.
docs: .venv/dev.stamp
	.venv/bin/sphinx-build -q -W --keep-going -E -d build/doctrees docs build/docs
	@echo "open build/docs/index.html"

lint: .venv/dev.stamp
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/pyright
	.venv/bin/lint-imports
	@$(MAKE) --no-print-directory docs

clean:
	rm -rf .venv .cache build dist .pytest_cache .ruff_cache .hypothesis .import_linter_cache

# A stamp is newer than what it was built from, so an interrupted install starts over. Modules are
# compiled when they are first imported: of what is installed most never are.
define INSTALL
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Expected Python 3.11 or newer, found $$($(PYTHON) -V 2>&1): name one, as in 'make walk PYTHON=python3.12'." >&2; exit 2; }
	@echo "Installing into .venv: once, a minute or two." >&2
	@$(PYTHON) -m venv .venv
	@.venv/bin/python -m pip install --quiet --no-compile --constraint constraints.txt --editable
endef

.venv/run.stamp: pyproject.toml constraints.txt
	$(INSTALL) .
	@touch $@

.venv/dev.stamp: pyproject.toml constraints.txt
	$(INSTALL) '.[deploy,dev,gym,hzd,mcap,onnx,video]'
	@touch .venv/run.stamp $@
