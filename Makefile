# make demo, make test: all set-up included. Needs Python 3.11 or later with venv, and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test test-slow lint docs benchmark paper clean

demo: $(STAMP)
	$(BIN)/pinograsp plan scenes/glovebox.yaml --task sphere --starts 1304 --seed 0

# Each file is one worker's: its fixtures are made once.
test: $(STAMP) lint
	$(BIN)/python -m pytest -q --numprocesses=logical --maxprocesses=4 --dist=loadfile

test-slow: $(STAMP)
	$(BIN)/python -m pytest -q -m slow

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Into out/site; nothing is fetched, neither now nor by a reader. --strict: a warning is an error.
docs: $(STAMP)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

benchmark: $(STAMP)
	$(BIN)/python tools/benchmark.py

# Goes on where it was interrupted; what is in out/paper/results already is not computed again.
paper: $(STAMP)
	$(BIN)/python tools/reproduce_paper.py out/paper --alternative --sweep --compare --algorithms

$(STAMP): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[dev,docs]'
	touch $(STAMP)

clean:
	rm -rf $(VENV) out
