# Everything is installed into .venv; nothing outside this folder is touched.
# Needed beforehand: make, and CPython 3.10, 3.11, 3.12 or 3.13.

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
OUT ?= out
POLICIES ?= assets/policies
ARGS ?=

ifdef PYTHON
CANDIDATES := "$(PYTHON)"
# A Python that is asked for by name is used, even where .venv is ready with another.
VERSION := -c 'import sys; print(sys.version_info[:2])'
ifneq ($(shell { "$(PYTHON)" $(VERSION); } 2>&1),$(shell { $(BIN)/python $(VERSION); } 2>&1))
.PHONY: $(READY)
endif
else
# The newest first; also where pyenv keeps those that are not on the path.
PYENV_ROOT ?= $(HOME)/.pyenv
CANDIDATES := $(foreach minor,13 12 11 10,python3.$(minor) \
	$(wildcard $(PYENV_ROOT)/versions/3.$(minor).*/bin/python)) python3 python
endif

SUITABLE := import sys, venv, ensurepip; sys.exit(sys.implementation.name != "cpython" \
	or not (3, 10) <= sys.version_info[:2] <= (3, 13))

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-all lint format docs gallery policies lock soak dist clean

help:
	@echo 'make demo    drive a scenario and film it: $(OUT)/mixed.mp4'
	@echo 'make test    run the tests (some of them: make test ARGS="-k video")'
	@echo 'make test-all  run those too that take long: kills, hangs, films, wheels, other Pythons'
	@echo 'make lint    check style and types'
	@echo 'make format  put the style right where that can be done without thought'
	@echo 'make docs    build the site of docs/ into $(OUT)/docs; a broken link fails'
	@echo 'make gallery drive the bundled scenarios that changed, for docs/gallery.md'
	@echo 'make setup   only install; all of the above do so first where it is needed'
	@echo 'make policies  train again what assets/policies holds, to the same bytes'
	@echo 'make lock    resolve the dependencies anew into requirements.lock'
	@echo 'make soak    disturb 2000 episodes at random and see that nothing is lost: about an hour'
	@echo 'make dist    build what is published into dist, twice, and check it'
	@echo 'make clean   remove .venv, .venvs and what tools left behind; videos in $(OUT) stay'
	@echo 'All take PYTHON=/path/to/python3.12 (3.10 to 3.13); without it the newest there is.'

setup: $(READY)

demo: $(READY)
	@$(BIN)/fuzzyq run mixed --out "$(OUT)"

test: $(READY)
	@$(BIN)/python -m pytest -n auto --maxprocesses 4 --dist loadfile $(ARGS)

test-all:
	@$(MAKE) --no-print-directory test ARGS='-m "slow or not slow" $(ARGS)'

lint: $(READY)
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy

format: $(READY)
	@$(BIN)/ruff check --fix-only .
	@$(BIN)/ruff format .
	@$(BIN)/python docs/tools/code_links.py
	@$(BIN)/python docs/tools/figures.py

# MkDocs 1.6 tells of its successors at length with each build, unless it is asked not to.
docs: $(READY)
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --site-dir "$(abspath $(OUT))/docs"
	@echo "$(OUT)/docs/index.html"

gallery: $(READY)
	@$(BIN)/python docs/tools/gallery.py

# The commands are the package's to say; each policy then takes the place of the one before. A change
# in it shows in git. Trained anew each time: a checkpoint knows the version, and not the code.
policies: $(READY)
	@set -e; commands=$$($(BIN)/python -m fuzzyq_bullet.training.config); \
	mkdir -p "$(POLICIES)"; \
	printf '%s\n' "$$commands" | while read -r _ _ planner options; do \
		made="$(OUT)/policies/$$planner.json"; \
		echo "fuzzyq train $$planner $$options"; \
		$(BIN)/fuzzyq train "$$planner" $$options --anew --out "$$made" < /dev/null; \
		cp "$$made" "$(POLICIES)/$$planner.part"; \
		mv "$(POLICIES)/$$planner.part" "$(POLICIES)/$$planner.json"; \
	done

# Versions and hashes alone: where packages come from is for whoever installs them to say.
lock: $(READY)
	@$(BIN)/uv pip compile pyproject.toml --extra test --extra lint --extra docs --output-file requirements.lock \
		--universal --python-version 3.10 --generate-hashes --upgrade --quiet \
		--no-emit-index-url --no-emit-find-links --no-annotate --no-header
	@! grep -nE '://|^ *-(-index|-extra-index|-find-links|i|f)' requirements.lock

soak: $(READY)
	@$(BIN)/python -m tests.soak --out "$(OUT)/soak" $(ARGS)

# From what is committed, in two folders: whoever builds the same commit must get the same bytes. uv
# gets the checkers, which nothing else needs, and keeps them out of .venv.
dist: $(READY)
	@rm -rf dist
	@set -e; made=$$(mktemp -d); trap 'rm -rf "$$made"' EXIT; \
	for copy in one two; do \
		mkdir "$$made/$$copy"; git archive HEAD | tar -x -C "$$made/$$copy"; \
		$(BIN)/python -m build --no-isolation --outdir "$$made/dist-$$copy" "$$made/$$copy" >/dev/null; \
	done; \
	diff -r "$$made/dist-one" "$$made/dist-two"; \
	mv "$$made/dist-one" dist
	@$(BIN)/uv --quiet tool run twine==7.0.0 check --strict dist/*
	@$(BIN)/uv --quiet tool run cffconvert==2.0.0 --validate -i CITATION.cff
	@sha256sum dist/*
	@! git grep -n OWNER -- pyproject.toml CITATION.cff docs/how-to \
		|| echo 'OWNER still stands there for the account that publishes it'

clean:
	rm -rf $(VENV) .venvs build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): pyproject.toml requirements.lock
	@python=; \
	for candidate in $(CANDIDATES); do \
		if { "$$candidate" -c '$(SUITABLE)'; } 2>/dev/null; then python=$$candidate; break; fi; \
	done; \
	if [ -z "$$python" ]; then \
		echo 'fuzzyq_bullet needs CPython 3.10 to 3.13: PyBullet has ready-made wheels for these.' >&2; \
		echo 'Looked at:' >&2; \
		for candidate in $(CANDIDATES); do \
			found=$$("$$candidate" --version 2>/dev/null | head -n 1) 2>/dev/null; \
			echo "  $$candidate: $${found:-not there}" >&2; \
		done; \
		echo 'Point to one like this: make $(or $(MAKECMDGOALS),setup) PYTHON=/path/to/python3.13' >&2; \
		exit 1; \
	fi; \
	same='import sys; print(sys.version_info[:3])'; \
	if [ "$$({ $(BIN)/python -m pip --version >/dev/null && $(BIN)/python -c "$$same"; } 2>/dev/null)" \
		!= "$$("$$python" -c "$$same")" ]; then \
		echo "Setting up $(VENV) with $$("$$python" --version); this takes a minute or two ..."; \
		rm -rf $(VENV); \
		"$$python" -m venv $(VENV) || { rm -rf $(VENV); exit 1; }; \
	else \
		echo "Bringing $(VENV) up to date ..."; \
	fi
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input \
		--require-hashes --requirement requirements.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input \
		--no-deps --no-build-isolation --editable .
	@touch $@
