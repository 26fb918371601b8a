#!/usr/bin/env bash
# Gradescope runs this once, as root, while it builds the image. The course's own set-up installs
# what is missing with apt-get and pip: a compiler, bubblewrap, Python, ROS 2 Jazzy from PyPI.
set -eu
export DEBIAN_FRONTEND=noninteractive
cd "${GRADESCOPE_ROOT:-/autograder}/source"
apt-get update -q
apt-get install -y -q --no-install-recommends \
  bubblewrap g++ make python3 python3-dev python3-venv
sh environment/prepare.sh
