"""Sums the results of ctest: names what failed, then the closing line `N passed, N failed`, with `, N skipped` where there are any.

    count_tests.py [--slowest N] RESULT.xml...      the files of ctest --output-junit; exit status 0 only if something passed and nothing failed
    --slowest N: before it the N tests that took longest, so that one that has become slow is seen
"""
import argparse
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

parser = argparse.ArgumentParser()
parser.add_argument("--slowest", type=int, default=0)
parser.add_argument("results", nargs="*")
asked = parser.parse_args()

durations = []
counts = {"passed": 0, "failed": 0, "skipped": 0}
for name in asked.results:
    for case in xml.parse(name).getroot().iter("testcase"):
        status = case.get("status")
        kind = {"run": "passed", "notrun": "skipped", "disabled": "skipped"}.get(status, "failed")
        # ctest also says notrun where the program is missing; then the message says so.
        skipped = case.find("skipped")
        if kind == "skipped" and skipped is not None and "SKIP" not in (skipped.get("message") or "SKIP").upper():
            kind = "failed"
        counts[kind] += 1
        durations.append((float(case.get("time") or 0.0), Path(name).stem, case.get("name")))
        if kind == "failed":
            print(f"FAILED {Path(name).stem}: {case.get('name')}")
if asked.slowest and durations:
    print(f"the slowest of {len(durations)} tests, s ({sum(time for time, *_ in durations):.0f} in all, several at once):")
    for time, stage, test in sorted(durations, reverse=True)[:asked.slowest]:
        print(f"{time:8.1f}  {stage}: {test}")
line = f"{counts['passed']} passed, {counts['failed']} failed"
print(line + (f", {counts['skipped']} skipped" if counts["skipped"] else ""))
sys.exit(0 if counts["passed"] > 0 and counts["failed"] == 0 else 1)
