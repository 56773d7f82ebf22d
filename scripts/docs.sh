#!/usr/bin/env bash
# Makes pages from the headers, README.md and docs/, in build/docs/html. Fails with doxygen's words where it has any: where
# something public is not described, or a link leads nowhere.
# shellcheck source=scripts/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
need doxygen
rm -rf build/docs
mkdir -p build/docs
HMESH_VERSION=$(sed -n 's/^#define HMESH_VERSION_STRING "\(.*\)"$/\1/p' include/hmesh/core/version.hpp)
export HMESH_VERSION
step "Making build/docs/html/index.html ..." doxygen docs/Doxyfile
