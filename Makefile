# Every target but clean makes its own environment in .venv first; nothing outside this folder is changed.

PYTHON ?= python3
WORKERS ?= 2

BIN := .venv/bin
STAMP := .venv/.stamp
LINT_STAMP := .venv/.stamp-lint

.PHONY: demo test test-all lint bench bench-diagnosis clean

demo: $(STAMP)
	$(BIN)/softid demo

EXAMPLES = $(BIN)/python -m pytest -q --doctest-modules softid cli/softid_cli

# Kernels are compiled first, or each of the processes that share the tests would compile them.
test: $(STAMP)
	$(BIN)/softid warmup
	$(BIN)/python -m pytest -m "not slow" -n $(WORKERS)
	$(EXAMPLES)

test-all: $(STAMP)
	$(BIN)/softid warmup
	$(BIN)/python -m pytest -n $(WORKERS)
	$(EXAMPLES)

lint: $(LINT_STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(STAMP)
	$(BIN)/python -m pytest -q -s --benchmark-only --benchmark-columns=median,iqr,rounds tests/benchmarks
	for script in tests/benchmarks/*_of_*.py; do echo "== $$script"; $(BIN)/python $$script || exit 1; done

DRAWS ?= 2

bench-diagnosis: $(STAMP)
	$(BIN)/python tests/benchmarks/diagnosis_rates.py --kinds clean,single,other_form,outside,pair,background,tie --draws $(DRAWS)

clean:
	rm -rf .venv build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis

$(STAMP): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "softid needs Python 3.11 or later, but '$(PYTHON)' is $$($(PYTHON) --version 2>&1);" \
	       "name another with: make $(MAKECMDGOALS) PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { \
	  echo "$(PYTHON) cannot make environments: install its venv module" \
	       "(Debian and Ubuntu: apt install python3-venv)" >&2; exit 1; }
	@echo "making .venv (once, a few minutes) …"
	@test -x $(BIN)/pip || $(PYTHON) -m venv --clear .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[test]'
	@touch $@

$(LINT_STAMP): $(STAMP)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[test,lint]'
	@touch $@
