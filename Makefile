# make explore   set up, then explore lim_room and score the map
# make test      set up, then run the tests
# make scenarios set up, then run all scenarios with all their seeds: ten minutes
# make check     format, lint, types, import layers, tests

PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready

.PHONY: explore test scenarios check format

explore: $(READY)
	$(BIN)/burger explore --world lim_room --out runs/lim_room

test: $(READY)
	$(BIN)/pytest --numprocesses 2

scenarios: $(READY)
	$(BIN)/burger scenario run --jobs 2 --out runs/scenarios

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(MAKE) test

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "Python 3.11 or newer is needed; say make PYTHON=...")'
	$(PYTHON) -m venv .venv
	@echo "installing into .venv, about a minute ..."
	PIP_CONSTRAINT=constraints.txt $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev,ros]'
	@touch $@
