#!/usr/bin/env bash
# Gradescope runs this script once, as root, while it builds the image. The script installs a
# compiler, bubblewrap and Python with apt-get; the set-up of the course then installs ROS 2 Jazzy
# from PyPI.
set -eu
export DEBIAN_FRONTEND=noninteractive
cd "${GRADESCOPE_ROOT:-/autograder}/source"
apt-get update -q
apt-get install -y -q --no-install-recommends \
  bubblewrap g++ make python3 python3-dev python3-venv
sh environment/prepare.sh
