# Every command of the project: `make` lists them; nothing else needs to be typed on a fresh machine.

.DEFAULT_GOAL := help
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.ONESHELL:
.DELETE_ON_ERROR:
MAKEFLAGS += --no-builtin-rules --no-print-directory

# Any Python from 3.11 on: `make test PYTHON=python3.12`.
PYTHON ?= python3
PIP_VERSION := 26.3

VENV := $(CURDIR)/.venv
REQUIREMENTS := $(VENV)/requirements.stamp
PACKAGE := $(VENV)/package.stamp
STUDIO_MODULES := $(CURDIR)/studio/node_modules/.package-lock.json
STUDIO_PAGE := $(CURDIR)/python/springform/studio/static/index.html
STUDIO_SOURCES := $(shell find studio -name node_modules -prune -o -type f -print)
MESSAGES := studio/src/protocol/messages.ts
SCHEMA := docs/formats/design.schema.json
DEMO := runs/demo

# Cases of `springform bench`, and where their figures go.
CASES ?=
RESULTS ?= bench/results
BENCH := $(CURDIR)/build/bench
REFERENCE := $(BENCH)/libreference.so
BENCH_PACKAGES := $(BENCH)/packages.stamp
BASE ?= HEAD
MOST ?= 1.02

# The case `studio` measures a window in Chromium, too.
BENCH_PAGE := $(if $(filter default all studio,$(or $(CASES),default)),chromium $(STUDIO_PAGE))

# What a machine must have is checked before anything is built, and said in one line.
ifneq ($(filter-out help clean,$(MAKECMDGOALS)),)
  ifeq ($(shell command -v cargo),)
    $(error springFORM needs Rust 1.88 or newer: install it so that `cargo` is found, then try again)
  endif
  # Looked up before .venv goes into PATH: an environment must not be made by its own Python.
  BASE_PYTHON := $(shell command -v $(PYTHON))
  ifneq ($(shell $(or $(BASE_PYTHON),false) -c 'import sys; print(sys.version_info >= (3, 11))' 2> /dev/null),True)
    $(error springFORM needs Python 3.11 or newer, $(PYTHON) is not: name another with PYTHON=python3.12)
  endif
  ifneq ($(filter setup test lint format messages screenshots $(if $(BENCH_PAGE),bench),$(MAKECMDGOALS)),)
    ifneq ($(shell node -p 'process.versions.node.split(".")[0] >= 20' 2> /dev/null),true)
      $(error the studio needs Node.js 20 or newer with npm: install them so that `node` is found, then try again)
    endif
  endif
  ifneq ($(shell $(BASE_PYTHON) -c 'import ensurepip, venv; print(1)' 2> /dev/null),1)
    $(error $(PYTHON) can't make virtual environments: install the package python3-venv, or name another with PYTHON=python3.12)
  endif
endif

export PATH := $(VENV)/bin:$(PATH)
export VIRTUAL_ENV := $(VENV)
# One interpreter for clippy and for maturin, or the binding is compiled anew each time.
export PYO3_PYTHON := $(VENV)/bin/python
export PIP_DISABLE_PIP_VERSION_CHECK := 1
unexport PYTHONPATH PYTHONHOME

.PHONY: help
help: # list the commands
	@echo "make COMMAND, where COMMAND is one of"
	sed -n 's/^\([a-z]*\):[^#=]*# /  \1\t/p' Makefile | expand -t 13

.PHONY: demo
demo: $(PACKAGE) # evolve the three-cylinder net and draw it
	@rm -rf $(DEMO)
	springform evolve three-cylinders --out $(DEMO) --seed 1 --population 300 --insertions 2 --until-springs 2000
	springform plot $(DEMO) --out $(DEMO)/pictures
	echo "The run is in $(DEMO), its pictures are in $(DEMO)/pictures."

.PHONY: test
test: calculix chromium $(PACKAGE) $(STUDIO_PAGE) # run the tests of the crates, of the Python package and of the studio
	@cargo test --locked --quiet
	pytest -n 2
	cd studio && npx playwright test --project studio

# Programs that tests and benchmarks need besides Rust, Python and Node.js; where it may, `make` gets them by itself.
.PHONY: calculix
calculix:
	@$(call get,ccx,CalculiX,calculix-ccx)

.PHONY: chromium
chromium:
	@$(call get,chromium,Chromium,chromium)

# $(call get,COMMAND,NAME,DEBIAN PACKAGE)
define get
if command -v $(1) > /dev/null; then exit; fi
	as_root=
	[ "$$(id -u)" = 0 ] || as_root="sudo --non-interactive"
	if ! { command -v apt-get && $$as_root true; } &> /dev/null; then
		echo "$(2) is needed: install it (Debian: $(3)) so that \`$(1)\` is found, then try again" >&2
		exit 1
	fi
	echo "installing $(2) …"
	$$as_root apt-get update -qq
	$$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qq --yes --no-install-recommends $(3) > /dev/null
endef

.PHONY: lint
lint: $(PACKAGE) $(STUDIO_MODULES) # check layout, lints, types, layers and generated files
	@cargo fmt --all --check -- --files-with-diff
	cargo clippy --locked --quiet --workspace --all-targets -- -D warnings
	ruff check --quiet
	ruff format --quiet --diff
	mypy
	lint-imports
	python -c "$$print_schema" | diff $(SCHEMA) - || { echo "make schema renews $(SCHEMA)" >&2; exit 1; }
	$(print_messages) | diff $(MESSAGES) - || { echo "make messages renews $(MESSAGES)" >&2; exit 1; }
	cd studio && npx biome check --error-on-warnings && npx tsc

.PHONY: bench
bench: $(BENCH_PAGE) $(PACKAGE) $(REFERENCE) $(BENCH_PACKAGES) # time springFORM beside CHOLMOD and other engines; CASES="growth threads"
	@SPRINGFORM_REFERENCE=$(REFERENCE) SPRINGFORM_STUDIO=$(CURDIR)/studio \
	    $(BENCH)/venv/bin/python -c "from springform.cli import main; main()" \
	    bench $(CASES) --out $(RESULTS) --label "$$(git describe --always --dirty 2> /dev/null || echo unknown)"

.PHONY: stages
stages: # time every stage of an individual with Criterion
	@cargo bench --locked --quiet -p springform-evolution --bench stages

.PHONY: guard
guard: # count instructions here and at another commit: BASE=main, and fail above MOST=1.02 times
	@$(BASE_PYTHON) bench/guard.py $(BASE) $(MOST)

.PHONY: format
format: $(REQUIREMENTS) $(STUDIO_MODULES) # lay out Rust, Python and TypeScript code
	@cargo fmt --all
	ruff check --quiet --fix-only
	ruff format --quiet
	cd studio && npx biome check --write

.PHONY: schema
schema: $(PACKAGE) # write the schema of the design file
	@python -c "$$print_schema" > $(SCHEMA)

.PHONY: messages
messages: $(PACKAGE) $(STUDIO_MODULES) # write the types of the messages between engine and studio
	@$(print_messages) > $(MESSAGES)

.PHONY: pictures
pictures: demo # make the pictures of the README
	@mkdir -p docs/pictures
	cp $(DEMO)/pictures/net.png docs/pictures/three-cylinders-evolved.png

.PHONY: screenshots
screenshots: chromium $(PACKAGE) $(STUDIO_PAGE) # take the pictures of the studio
	@cd studio && npx playwright test --project pictures

.PHONY: lock
lock: # renew Cargo.lock and requirements.lock
	@cargo update --quiet
	$(BASE_PYTHON) -m venv --clear build/lock
	build/lock/bin/pip install --quiet pip==$(PIP_VERSION)
	build/lock/bin/python -c "$$print_requirements" | xargs -d '\n' build/lock/bin/pip install --quiet
	{ sed -n 1p requirements.lock; build/lock/bin/pip freeze; } > build/requirements.lock
	mv build/requirements.lock requirements.lock
	rm -r build/lock

.PHONY: setup
setup: $(PACKAGE) $(STUDIO_PAGE) # build everything into .venv, as the other commands do by themselves

.PHONY: clean
clean: # remove what was built; runs stay
	@rm -rf studio/node_modules studio/test-results python/springform/studio/static
	rm -rf .venv target build dist .hypothesis .pytest_cache .mypy_cache .ruff_cache .import_linter_cache
	find python tests bench -name __pycache__ -prune -exec rm -r {} +
	rm -f python/springform/_core*.so

$(PACKAGE): $(REQUIREMENTS) pyproject.toml Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name '*.toml')
	@echo "building springFORM; the first time takes a few minutes …"
	pip install --quiet --no-deps --no-build-isolation --editable .
	touch $@

$(REQUIREMENTS): requirements.lock
	@$(BASE_PYTHON) -m venv --clear $(VENV)
	pip install --quiet pip==$(PIP_VERSION)
	pip install --quiet --requirement requirements.lock
	touch $@

# Without CHOLMOD there are no ratios; that is said, and everything else is timed.
$(REFERENCE): bench/cholmod.c
	@mkdir -p $(BENCH)
	compile() { cc -O2 -Wall -Wextra -shared -fPIC -I/usr/include/suitesparse -o $@ $< -lcholmod; }
	compile 2> /dev/null && exit
	if command -v apt-get > /dev/null && [ "$$(id -u)" = 0 ]; then
	    apt-get update -qq
	    DEBIAN_FRONTEND=noninteractive apt-get install -qq --yes --no-install-recommends \
	        libsuitesparse-dev libopenblas0-pthread > /dev/null
	fi
	compile || echo "bench: no ratios: install the headers of SuiteSparse (Debian: libsuitesparse-dev) and OpenBLAS" >&2

# An environment of its own, in which the packages of .venv are seen, too.
$(BENCH_PACKAGES): $(REQUIREMENTS) $(REFERENCE) bench/requirements.txt bench/requirements-jax.txt
	@$(BASE_PYTHON) -m venv --clear $(BENCH)/venv
	printf '%s\n' $(CURDIR)/python $(VENV)/lib/python3.*/site-packages \
	    > "$$(echo $(BENCH)/venv/lib/python3.*/site-packages)/springform.pth"
	for package in $$(cat bench/requirements.txt $(if $(JAX),bench/requirements-jax.txt) | sed 's/#.*//'); do
	    $(BENCH)/venv/bin/pip install --quiet --no-deps "$$package" \
	        || echo "bench: $$package can't be had here: its figures are left out" >&2
	done
	touch $@

$(STUDIO_MODULES): studio/package.json studio/package-lock.json studio/.npmrc
	@cd studio && npm ci --silent
	touch $@

$(STUDIO_PAGE): $(STUDIO_MODULES) $(STUDIO_SOURCES)
	@cd studio && npx vite build --logLevel warn
	touch $@

print_messages = python -c "$$print_message_schema" \
	| studio/node_modules/.bin/json2ts --ignoreMinAndMaxItems --bannerComment "$$messages_banner"

define print_message_schema
import json
from springform.studio import messages
print(json.dumps(messages.schema()))
endef
export print_message_schema
export messages_banner := // Messages between engine and window, generated from python/springform/studio/messages.py by `make messages`.

define print_schema
from springform import canonical_text, design_file
print(canonical_text.json_text(design_file.json_schema()), end="")
endef
export print_schema

# What pyproject.toml asks for, to build, to run and to develop, a line each.
define print_requirements
import tomllib
asked = tomllib.load(open("pyproject.toml", "rb"))
project = asked["project"]
groups = asked["build-system"]["requires"], project["dependencies"], project["optional-dependencies"]["dev"]
print(*sum(groups, []), sep="\n")
endef
export print_requirements
