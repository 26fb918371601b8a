# The goals of the full project, included by the Makefile; students' copies omit them.
#
#|  make grade                grade everything in submitted/; for options, type
#|                            .venv/bin/autograder grade --help
#|  make release              generate notebooks/ from solutions/, check the course, pack the
#|                            students' copy (ARGS=--answers adds worked answers)
#|  make execute              execute the solved lessons and write the date into those that ran
#|                            without an error (ARGS=03_topics chooses some)
#|  make book                 execute the lessons and write them as web pages,
#|                            into autograder/_work/book/html
#|  make quick                check style and types and run the quick unit tests: under a minute
#|  make test                 run all tests except browser, cluster, LTI, PostgreSQL and benchmarks
#|  make test-browser         test JupyterLab and formgrader in headless Chromium; also
#|                            test-cluster (Dask), test-lti (a learning platform on loopback) and
#|                            test-postgres (a real server), and test-routes (container, Binder
#|                            and workflow files, each read by its own tool)
#|  make hub                  run a JupyterHub for a class on this machine, as root (docs/hub.md);
#|                            make test-hub tests it in headless Chromium
#|  make check                check style, types, words, and that generated files are up to date
#|  make coverage             write docs/coverage.md: what the course claims, teaches and proves
#|  make judgement            write docs/agreement.md, mutants.md, causes.md: how well the grader
#|                            judges
#|  make bench                run the benchmarks; half an hour, preferably on a quiet machine
#|  make soak                 judge all samples 12 times, with and without load; 90 minutes

.PHONY: grade quick hub test test-browser test-hub test-cluster test-lti test-postgres test-routes check coverage judgement release execute book bench soak

# Without cached bytecode, each process would compile all tests and the grader again.
quick test: export PYTHONDONTWRITEBYTECODE =

# A submission for review does not make this goal fail.
grade: prepare
	@exec $(PY) -m autograder grade --allow-review $(ARGS)

# Run this after each change. Type checking takes half a minute the first time, then a second.
quick: prepare
	$(PY) -m ruff check
	$(PY) -m ruff format --check
	$(PY) -m mypy
	@exec $(WITH_ROS) python -m pytest -q -n 2 --dist loadfile -m 'not ros and not slow' tests/unit $(ARGS)

# Run more test files in parallel than there are processors, because most tests wait. The tests of
# a file run in order. ARGS='-n 0' runs one file after another.
test: prepare
	@exec $(WITH_ROS) python -m pytest -n 3 --dist loadfile $(ARGS)

# HUB=FILE replaces the settings in deploy/hub/hub.toml.
hub: export HUB := $(HUB)
hub: prepare
	@exec $(PY) -m deploy.hub

test-browser test-hub: test-%: prepare
	@for name in chromium chromium-browser google-chrome; do \
	  command -v $$name >/dev/null && exit; \
	done; echo 'Chromium is not installed. Try: sudo apt-get install -y chromium'; exit 1
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  -r environment/requirements-browser.txt
	@exec $(WITH_ROS) python -m pytest -m $* $(ARGS)

# These tests use other programs: a scheduler with two workers, a learning platform, a PostgreSQL
# server, and the tools that read container and workflow files.
test-cluster test-lti test-postgres test-routes: test-%: prepare
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  -r environment/requirements-$*.txt
	@exec $(WITH_ROS) python -m pytest -m $* $(ARGS)

check: prepare
	$(PY) -m ruff check
	$(PY) -m ruff format --check
	$(PY) -m mypy
	$(PY) -m autograder release --check
	$(PY) -m tests.claims.coverage --check
	$(PY) -m tests.attacks.table --check
	$(PY) -m tests.judgement.agreement --check
	$(PY) -m tests.judgement.mutants --check
	$(PY) -m tests.judgement.causes --check
	$(PY) -m pytest -q tests/unit/test_style.py

coverage: prepare
	@exec $(PY) -m tests.claims.coverage

# Run every program that has no stored recording, which takes some minutes. With the secret of the
# tests, the tables are the same on every machine.
judgement: export COURSE_SECRET = the secret of the tests
judgement: prepare
	$(PY) -m tests.judgement.agreement
	$(PY) -m tests.judgement.mutants
	$(PY) -m tests.judgement.causes

release: prepare
	@exec $(PY) -m autograder release $(ARGS)

execute: prepare
	@exec $(PY) -m autograder.authoring.execute $(ARGS)

# Sphinx needs an older docutils than the course, so it has a separate virtual environment.
book: SPHINX = $(abspath $(VENV))/book/bin/python
book: prepare
	@test -x '$(SPHINX)' || $(PY) -m venv '$(VENV)/book'
	@'$(SPHINX)' -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	  -r environment/requirements-book.txt
	@exec $(PY) -m autograder.authoring.book --sphinx '$(SPHINX)'

bench: prepare
	$(PY) -m benchmarks.one_submission
	$(PY) -m benchmarks.stock_nbgrader
	$(PY) -m benchmarks.soak --recordings

# ARGS='--minutes 30' ends the run sooner.
soak: prepare
	@exec $(PY) -m benchmarks.soak $(ARGS)
