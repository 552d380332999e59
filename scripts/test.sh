#!/usr/bin/env bash
# Installs what is missing, builds everything and runs all tests. Its last lines are
# ctest's own summary, its exit code ctest's.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh --colmap --slurm
scripts/install_dependencies.sh --arm64 || echo "the test on ARM will be skipped"
scripts/install_dependencies.sh --browser || echo "the test in a browser will be skipped"
scripts/install_pycolmap.sh --before || echo "the tests with pycolmap will be skipped"
cmake --preset release
cmake --build --preset release
exec ctest --test-dir build/release --output-on-failure -j2
