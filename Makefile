# The commands of the course. Most goals first prepare what they need: a virtual environment with
# ROS 2, the course's ROS package and a Jupyter kernel. If everything is ready, this takes no time.
# `make help` prints the lines that begin with #|. Students' copies lack instructors.mk.
#
#|  make lab                  open JupyterLab with notebooks/START_HERE.ipynb
#|  make publisher            run the course's publisher node in this terminal
#|  make subscriber           run the course's subscriber node in this terminal
#|  make prepare              prepare everything; most other goals do this first
#|  make doctor               list what is installed and what is missing, without network
#|  make clean                remove everything that was prepared
#
# Choices: PYTHON=python3.11 (which Python), VENV=.venv-3.11 (where), ROS_SOURCE=wheels|sourced.

VENV ?= .venv
PYTHON ?=
ROS_SOURCE ?=
ARGS ?=
export VENV PYTHON ROS_SOURCE

SHELL := /bin/sh
.DEFAULT_GOAL := help
# All goals share one environment and one terminal, so they run one at a time.
.NOTPARALLEL:
.PHONY: help prepare lab publisher subscriber doctor clean

# An absolute VENV is used unchanged; a relative one refers to this folder.
PY = $(VENV)/bin/python
WITH_ROS = $(PY) -S -E -m environment run
NODES = $(VENV)/workspace/install/temp_monitor_pkg/lib/temp_monitor_pkg
# JupyterLab refuses to run as root unless an option allows it, for example in a container.
AS_ROOT = $(if $(filter 0,$(shell id -u)),--allow-root)

include $(wildcard instructors.mk)

.DEFAULT:
	@echo 'make $@: this copy of the course has no such goal. Try: make help' >&2; exit 2

help:
	@sed -n 's/^#|//p' $(MAKEFILE_LIST)
	@echo
	@sed -n 's/^# Choices/  Choices/p' $(firstword $(MAKEFILE_LIST))

prepare:
	@sh environment/prepare.sh

# The server's root is the entire project, because nbgrader's formgrader needs access to it; the
# file browser opens in notebooks/.
lab: prepare
	@exec $(WITH_ROS) jupyter lab $(AS_ROOT) --ServerApp.root_dir='$(CURDIR)' \
	  --FileContentsManager.preferred_dir='$(CURDIR)/notebooks' \
	  --LabApp.default_url=/lab/tree/notebooks/START_HERE.ipynb \
	  --LabApp.workspaces_dir='$(abspath $(VENV))/ros2_course/workspaces' \
	  --MultiKernelManager.default_kernel_name=ros2_jazzy $(ARGS)

publisher: prepare
	@exec $(WITH_ROS) '$(NODES)/temp_publisher' $(ARGS)

subscriber: prepare
	@exec $(WITH_ROS) '$(NODES)/temp_subscriber' $(ARGS)

# This goal prepares nothing, because doctor reports what is missing.
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
