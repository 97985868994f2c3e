# make demo: set up, compute a rough adhesive contact, show it.   make test: set up, run every check, build the docs.
# make test-all: the long forms of tests as well, some fifty minutes more.
# make docs: build the documentation into docs/_build/html, examples and all.
# make studies: measure error against run time, the extremes, and what leaving out saves, in reduced forms that say what
# they leave out, three minutes and compiling; report in results/studies. make studies-full: all of it, about an hour.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
RUNS   := $(VENV)/runs
READY  := $(VENV)/ready
# Images of containers often forbid bytecode; each of many processes would compile all that it imports anew.
export PYTHONDONTWRITEBYTECODE :=
# Workers share the cores: threads of BLAS in each would wait for each other.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest
TESTS  := $(PYTEST) -n auto
UNCOMPILED := $(addprefix tests/,asperity kernels numerics shapes springs $(addsuffix .py,pipelines/test_one_asperity \
  $(addprefix aggregate/test_,few_searches machine shapes_in_ensembles sum) \
  $(addprefix interaction/test_,close contacts green jkr_parts jkr_shapes)))

.PHONY: demo test test-all tests sums others uncompiled docs studies studies-full installed setup lint lock release
.PHONY: clean

demo: installed
	@mkdir -p results
	@$(BIN)/roughmdr run pipelines/scenes/rubber_on_glass.toml -o results/rubber_on_glass.nc --fresh
	@$(BIN)/roughmdr plot results/rubber_on_glass.nc -o results/rubber_on_glass.png --with-expected

# First what compiles for all that follows, beside what compiles nothing; then all that finds its code compiled.
test: setup
	@$(MAKE) --no-print-directory -j2 sums lint uncompiled
	@$(MAKE) --no-print-directory -j2 others docs

# The tests, and those of kernels, sums and shapes again where nothing is compiled.
tests: sums others uncompiled

# One process compiles what most tests need; the workers, who would each compile it, find it on disk.
sums: setup
	$(PYTEST) tests/aggregate

others: setup
	$(TESTS) --dist loadfile --ignore tests/aggregate

uncompiled: setup
	NUMBA_DISABLE_JIT=1 $(TESTS) --dist loadfile $(UNCOMPILED)

test-all: test
	$(TESTS) --dist worksteal -m large
	NUMBA_DISABLE_JIT=1 $(TESTS) --dist worksteal -m elsewhere $(UNCOMPILED)

docs: setup
	$(BIN)/sphinx-build -q -W --keep-going -b html docs docs/_build/html
	@echo "docs/_build/html/index.html"

studies: setup
	@$(BIN)/python pipelines/study.py all --quick -o results/studies

studies-full: setup
	@$(BIN)/python pipelines/study.py all -o results/studies

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Every file of every installed package is still there.
INTACT := import sys; from importlib.metadata import distributions; \
  sys.exit(any(not file.locate().exists() for package in distributions() for file in package.files or []))
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps

# Install what runs need. It counts only when it was finished from these lock files by a Python that still runs.
installed:
	@if ! cmp -s requirements-run.lock $(RUNS) || { test -e $(READY) && ! cmp -s requirements.lock $(READY); } || \
	  ! { $(BIN)/python -c "$(INTACT)" && $(BIN)/roughmdr --version; } >/dev/null 2>&1; then \
	  $(MAKE) --no-print-directory $(RUNS); fi

# Install what tests and docs need as well.
setup: installed
	@if ! test -e $(READY); then \
	  echo "installing the packages of tests and docs (once, half a minute)"; \
	  rm $(RUNS) && $(INSTALL) --no-compile --require-hashes -r requirements.lock \
	  && cp requirements.lock $(READY) && cp requirements-run.lock $(RUNS); fi

.PHONY: $(RUNS)
$(RUNS):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "roughmdr needs Python 3.11 or newer: make PYTHON=python3.12"; exit 1; }
	@rm -rf $(VENV)
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	  echo "$(PYTHON) cannot make a virtual environment; on Debian and Ubuntu: apt-get install python3-venv"; exit 1; }
	@echo "installing the locked packages into $(VENV) (once, half a minute)"
	@$(INSTALL) --no-compile --require-hashes -r requirements-run.lock
	@$(INSTALL) --no-build-isolation -e .
	@cp requirements-run.lock $(RUNS)

# Renew the lock files, of all packages and of those that runs need: versions and hashes, no addresses. Needs uv.
COMPILE := uv pip compile --universal --generate-hashes --python-version 3.11 --no-header --no-annotate
lock:
	$(COMPILE) --group dev pyproject.toml -o requirements.lock
	$(COMPILE) --group build --extra cluster -c requirements.lock pyproject.toml -o requirements-run.lock

# Test at length, tag a version, build its wheel and source archive into dist/; nothing is uploaded: make release VERSION=0.1.0.
release: test-all
	$(BIN)/python .ci/release.py $(VERSION)

clean:
	rm -rf $(VENV) results dist docs/_build docs/gallery docs/reference/generated .pytest_cache .mypy_cache .ruff_cache .hypothesis
