#!/bin/sh
# Prepare the environment; make calls this before most goals, from the root of the project.
# Instant if there is nothing to do. Otherwise, find a Python that can run the set-up. The set-up
# itself chooses the Python for the course, which may be a different one.

own="${VENV:-.venv}/bin/python"
# -S: without site, for a quick start that no installed package can affect.
if [ -x "$own" ] && "$own" -S -E -m environment ready 2>/dev/null; then
  exit 0
fi

usable() {
  "$1" -S -E -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2])' >/dev/null 2>&1
}

find_python() {
  for python in ${PYTHON:+"$PYTHON"} python3.12 python3.11 python3.13 python3.10 python3 \
    /usr/bin/python3 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.1[0-3]*/bin/python3; do
    if usable "$python"; then
      return 0
    fi
  done
  return 1
}

if ! find_python; then
  packages='python3 python3-venv python3-dev'
  as_root=''
  [ "$(id -u)" = 0 ] || as_root='sudo -n'
  if command -v apt-get >/dev/null && { [ -z "$as_root" ] || sudo -n true 2>/dev/null; }; then
    echo 'set-up: no Python found: installing it with apt-get' >&2
    # shellcheck disable=SC2086 - the lists are meant to be split
    { $as_root apt-get update -q && DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -q \
      --no-install-recommends $packages; } </dev/null >&2
  fi
  if ! find_python; then
    echo 'set-up: expected Python 3.10 to 3.13, found none' >&2
    echo "  try: sudo apt-get install -y $packages" >&2
    exit 1
  fi
fi

exec "$python" -S -E -m environment prepare
