#!/usr/bin/env bash
# Fails when a C++ file, or a script of the page, is not formatted as .clang-format says; clang-format -i FILE mends it.
set -euo pipefail
cd "$(dirname "$0")/../.."
find cmake core bullet_ref experiments tests \( -name '*.[ch]pp' -o -path '*/report/page/*.js' \) -print0 | xargs -0 -r clang-format --dry-run -Werror
