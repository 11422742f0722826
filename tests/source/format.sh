#!/usr/bin/env bash
# Fails when a C++ file is not formatted as .clang-format says; the mend: clang-format -i FILE.
set -euo pipefail
cd "$(dirname "$0")/../.."
git ls-files -z '*.cpp' '*.hpp' | xargs -0 -r clang-format --dry-run -Werror
