# `make` alone lists the targets. Works with the make of macOS (GNU make 3.81).

# The first of these that is Python 3.11 or newer makes .venv; or say `make lab PYTHON=/path/to/python`.
PYTHON = python3 python3.13 python3.12 python3.11
VENV = .venv
BIN = $(VENV)/bin
SEED = 7

# Files that say what has been done already, so that a second `make` starts at once.
FOUND = $(VENV)/pyvenv.cfg
READY = $(VENV)/.installed
TEST_READY = $(VENV)/.installed-test
BENCH_READY = $(VENV)/.installed-bench

# The tests of the package are independent: a worker that is done takes some from the other.
PYTEST = $(BIN)/pytest -n 2 --dist worksteal
# Lax: only cells marked NBVAL_CHECK_OUTPUT are compared, an exception fails in any cell.
# --dist loadfile: the cells of one notebook need one kernel, in order.
NBVAL = $(BIN)/pytest -n 2 --dist loadfile --nbval-lax --nbval-current-env --nbval-cell-timeout=120

.PHONY: help lab test lint nbval pytest grade solve bench clean
.DEFAULT_GOAL = help

help: ## print this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-8s %s\n", $$1, $$2 }' Makefile

lab: $(READY) ## set up, then open the course in JupyterLab
	$(BIN)/gpcourse lab

# Two workers on two cores: more threads in BLAS would only wait for each other.
nbval pytest: export OPENBLAS_NUM_THREADS = 1

test: lint nbval pytest ## set up, then run all that CI runs

lint: $(TEST_READY) ## check style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

nbval: $(TEST_READY) ## run every notebook, with its stubs and solved
	$(NBVAL) notebooks
	rm -rf build/solved
	$(BIN)/gpcourse solve notebooks/*.ipynb --out build/solved
	$(NBVAL) build/solved

pytest: $(TEST_READY) ## run the tests of the package
	$(PYTEST)

grade: $(READY) ## grade the sample class into grades/, with SEED=7
	$(BIN)/gpcourse grade data/sample_class --out grades --seed $(SEED) --allow-unconfined

solve: $(READY) ## write solved notebooks into solved/
	$(BIN)/gpcourse solve notebooks/*.ipynb --out solved

bench: $(BENCH_READY) ## compare the speed with other libraries (installs them, takes minutes)
	$(BIN)/python benchmarks/halfedge.py
	$(BIN)/python benchmarks/registration.py
	$(BIN)/python benchmarks/smoothing.py
	$(BIN)/python benchmarks/viewer.py

clean: ## remove .venv and everything that was built; keeps grades/, solved/ and the notebooks
	rm -rf $(VENV) build dist .pytest_cache .ruff_cache .mypy_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(FOUND):
	@for python in $(PYTHON); do \
	  if "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then \
	    echo "Making $(VENV) with $$("$$python" --version)"; \
	    "$$python" -m venv $(VENV) && exit 0; \
	    rm -rf $(VENV); \
	    echo "$$python cannot make a virtual environment. On Debian and Ubuntu: sudo apt install python3-venv" >&2; \
	    exit 1; \
	  fi; \
	done; \
	echo "gpcourse needs Python 3.11 or newer; tried: $(PYTHON)." >&2; \
	echo "Install it from https://www.python.org/downloads/, or name yours: make $(MAKECMDGOALS) PYTHON=/path/to/python" >&2; \
	exit 1

$(READY): $(FOUND) pyproject.toml
	@echo "Installing the course into $(VENV); the first time takes a minute or two"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(TEST_READY): $(FOUND) pyproject.toml
	@echo "Installing the course and its tests into $(VENV); the first time takes a minute or two"
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $(READY) $@

# A peer that cannot be built here is left out, and the benchmark says so.
$(BENCH_READY): $(READY) benchmarks/peers.txt
	@while read -r peer; do \
	  $(BIN)/python -m pip install --quiet --disable-pip-version-check "$$peer" \
	    || echo "$$peer cannot be installed here: its rows will be missing" >&2; \
	done < benchmarks/peers.txt
	@touch $@
