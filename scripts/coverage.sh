#!/usr/bin/env bash
# Coverage of the library by its tests: lines and branches without the edges of exceptions, a folder a row, worst files, and what is not reached.
#
#   scripts/coverage.sh [FOLDER]        builds into FOLDER (build-coverage), runs the tests, writes FOLDER/coverage.{txt,json,html}
#
# Tests that need recorded data run if the data are there. SCHULER_COVERAGE_TESTS: regular expression of the tests to leave out.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
folder=${1:-build-coverage}
command -v gcovr >/dev/null || { echo "coverage: gcovr is missing: scripts/packages.sh --install develop" >&2; exit 1; }
# half an hour to build, an hour of tests; counters that threads disturb are skipped (--gcov-ignore-parse-errors)
left_out=${SCHULER_COVERAGE_TESTS:-'^house\.|ui_page|ui_bundle|Slow|_real$|real_data|papers'}

cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DSCHULER_COVERAGE=ON -DSCHULER_BENCH=OFF -DSCHULER_WERROR=OFF -DSCHULER_PCH=OFF \
    -DSCHULER_TESTS=ON -DSCHULER_UNITY=ON -DSCHULER_PYTHON=ON >/dev/null
cmake --build "$folder" >"$folder/build.log" || { tail -n 40 "$folder/build.log"; exit 1; }
find "$folder" -name '*.gcda' -delete
ctest --test-dir "$folder" -j "$(nproc)" --timeout 1200 -E "$left_out" >"$folder/tests.log" || grep -A20 'tests FAILED' "$folder/tests.log" || true
grep 'tests passed' "$folder/tests.log" || true

gcovr --root . --filter 'src/schuler/' --object-directory "$folder" --exclude-throw-branches --exclude-unreachable-branches --gcov-ignore-parse-errors -j "$(nproc)" \
    --json "$folder/coverage.json" --txt "$folder/coverage.txt" --html-details "$folder/coverage.html" >/dev/null
python3 scripts/coverage_table.py "$folder/coverage.json"
