# strikewave: `make demo` sets everything up, runs the published machine and writes its reports; `make test` runs all tests.
# Needs Python 3.11 or newer with venv, and make. On Windows: pip install . (see README.md).

VENV ?= .venv
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$p; break; }; done)
BIN = $(VENV)/bin
BENCH = .bench/venv
INSTALL = install --quiet --disable-pip-version-check --no-deps
COMPILE = .uv/bin/uv pip compile --quiet pyproject.toml requirements/build.in --constraint constraints.txt --universal \
	--python-version 3.11 --generate-hashes --no-annotate --no-header --default-index https://pypi.org/simple
JOBS ?= 2
# asserts are not rewritten, which takes each worker half a minute: what fails is run again with its values
PYTEST = $(BIN)/python -m pytest -n $(JOBS) --dist worksteal --assert=plain
SEED ?= 1
COUNT ?= 30
CASES ?= li-ma-2019 li-ma-2019-fig13

.PHONY: demo test verify validate mutate docs docs-pdf package pictures lint requirements bench clean help
.DEFAULT_GOAL := help

help:
	@echo "make demo    set up, then run the published machine into out/ with a report each ($(CASES))"
	@echo "make test    set up, then run the tests but for those of make verify"
	@echo "make verify  set up, then the longer checks: damaged files of every format, all planted records, equal blows, elements (with CalculiX and gmsh where they are installed), the app in a browser"
	@echo "make validate  set up, then studies that run once, outside CI: every comparison with what is known (docs/validation.md), the whole reproduction, finer maps (out/validate)"
	@echo "make mutate   set up, then try COUNT ($(COUNT)) small faults, drawn by SEED ($(SEED)), in each ROOM (all rooms), and say which no test sees"
	@echo "make docs     set up, then build the site (docs/_build/html) and the man page (docs/_build/man); notebooks and pages are run, warnings are errors"
	@echo "make docs-pdf  the same, then the manual as one PDF (docs/_build/strikewave-manual.pdf; needs Pango)"
	@echo "make package  set up, then build wheel and source distribution (dist), check both, install and run the wheel alone with each of PYTHONS"
	@echo "make pictures  set up, then draw the screens and photograph the report that README and docs show (docs/images; report and app with Chromium)"
	@echo "make lint    set up, then style, types, import contract and budgets of lines and files; whether packages fit together, and are known to be vulnerable"
	@echo "make requirements  write requirements/ anew, the packages with their SHA-256, from constraints.txt (with uv)"
	@echo "make bench   set up with the peers ($(BENCH)), then time everything beside them (writes docs/benchmarks.md)"
	@echo "make clean   remove the environment and caches"

demo: $(VENV)/core
	@for case in $(CASES); do $(BIN)/strikewave run $$case || exit 1; done
	@for case in $(CASES); do echo "open in a browser: out/$$case/report.html"; done

test: $(VENV)/dev
	@$(BIN)/python -m compileall -q -j $(JOBS) src tests
	@$(BIN)/python scripts/compile_kernels.py $(JOBS)
	$(PYTEST) || { $(BIN)/python -m pytest --last-failed; exit 1; }

verify: $(VENV)/dev
	$(PYTEST) -m verify || { $(BIN)/python -m pytest --last-failed -m verify; exit 1; }

# one file a study, in the order of their names; each prints what it found and writes its tables and pictures
validate: $(VENV)/dev
	@for study in scripts/validate/*.py; do echo "$$study"; $(BIN)/python "$$study" || exit 1; done

# small faults in the code of a room, one at a time: which of them do the tests beside it see? (.mutants keeps what came)
mutate: $(VENV)/dev
	@$(BIN)/python scripts/mutate.py $(ROOM) --seed $(SEED) --count $(COUNT) --jobs $(JOBS)

# equations, links and cells are checked by the build: what is wrong there ends it
docs: $(VENV)/docs
	$(BIN)/python -m sphinx -W --keep-going -q -j $(JOBS) -b html -d docs/_build/doctrees docs docs/_build/html
	$(BIN)/python -m sphinx -W -q -b man -d docs/_build/doctrees docs docs/_build/man
	@echo "open in a browser: docs/_build/html/index.html"

docs-pdf: docs
	$(BIN)/python -m sphinx -W -q -b singlehtml -D html_theme=basic -d docs/_build/doctrees docs docs/_build/singlehtml
	$(BIN)/python scripts/manual_pdf.py

package: $(VENV)/package
	$(BIN)/python scripts/package/check.py --platforms $(PYTHONS:%=--python %)

pictures: $(VENV)/dev
	$(BIN)/python scripts/draw_pictures.py
	$(BIN)/python scripts/draw_app_pictures.py

lint: $(VENV)/dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/budget.py
	$(BIN)/python -m pip check
	$(BIN)/python scripts/known_vulnerabilities.py

# for a change of constraints.txt or pyproject.toml: uv finds the SHA-256 of all files of each version, for all systems
requirements: pyproject.toml constraints.txt
	@$(PYTHON) -m venv .uv && .uv/bin/python -m pip install --quiet uv
	@$(COMPILE) -o requirements/core.txt
	@$(COMPILE) --extra dev --extra formats --extra mesh --extra pdf --extra bayes --extra app --extra cluster --extra optuna -o requirements/dev.txt
	@$(COMPILE) --extra docs -o requirements/docs.txt
	@$(COMPILE) --extra package -o requirements/package.txt

bench: $(BENCH)/peers
	$(BENCH)/bin/python benchmarks/bench.py

# each file has to be one of those whose SHA-256 stand in requirements; `pip check` in `make lint` finds what they lack
%/core: pyproject.toml requirements/core.txt
	@if [ -z "$(PYTHON)" ]; then \
		echo "strikewave needs Python 3.11 or newer: install it (Debian: apt-get install python3 python3-venv), or name it: make demo PYTHON=/path/to/python3"; exit 1; fi
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { \
		echo "$(PYTHON) lacks the module venv: install it (Debian, Ubuntu: apt-get install python3-venv; Fedora: dnf install python3), then run make again"; exit 1; }
	@echo "setting up $* (once; about a minute)"
	@rm -f $*/core $*/dev $*/docs $*/package $*/peers
	@$(PYTHON) -m venv $*
	@$*/bin/python -m pip $(INSTALL) --require-hashes -r requirements/core.txt
	@$*/bin/python -m pip $(INSTALL) --no-build-isolation -e .
	@touch $@

$(VENV)/dev: $(VENV)/core requirements/dev.txt
	@echo "adding the tools for tests (once)"
	@$(BIN)/python -m pip $(INSTALL) --require-hashes -r requirements/dev.txt
	@touch $@

$(VENV)/docs: $(VENV)/core requirements/docs.txt
	@echo "adding the tools that build the site (once)"
	@$(BIN)/python -m pip $(INSTALL) --require-hashes -r requirements/docs.txt
	@touch $@

$(VENV)/package: $(VENV)/core requirements/package.txt
	@echo "adding the tools that build and check the package (once)"
	@$(BIN)/python -m pip $(INSTALL) --require-hashes -r requirements/package.txt
	@touch $@

# one after the other, so that one that cannot be had keeps no other away; what failed is tried again next time
$(BENCH)/peers: $(BENCH)/core benchmarks/requirements.txt benchmarks/constraints.txt
	@echo "adding the peers (once; about a minute)"
	@failed=; while read -r peer; do \
		case "$$peer" in "#"* | "") continue ;; esac; \
		$(BENCH)/bin/python -m pip install --quiet --disable-pip-version-check \
			-c constraints.txt -c benchmarks/constraints.txt "$$peer" < /dev/null \
			|| { failed=1; echo "$$peer could not be installed: the tables will say so"; }; \
	done < benchmarks/requirements.txt; \
	[ -n "$$failed" ] || touch $@

clean:
	rm -rf $(VENV) dist docs/_build docs/examples docs/reference .bench .uv .audit .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
