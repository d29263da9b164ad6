"""Sums the results of ctest: names what failed, then the closing line `N passed, N failed`, with `, N skipped` where there are any.

    count_tests.py RESULT.xml...      the files of ctest --output-junit; exit status 0 only if something passed and nothing failed
"""
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

counts = {"passed": 0, "failed": 0, "skipped": 0}
for name in sys.argv[1:]:
    for case in xml.parse(name).getroot().iter("testcase"):
        status = case.get("status")
        kind = {"run": "passed", "notrun": "skipped", "disabled": "skipped"}.get(status, "failed")
        # ctest also says notrun where the program is missing; then the message says so.
        skipped = case.find("skipped")
        if kind == "skipped" and skipped is not None and "SKIP" not in (skipped.get("message") or "SKIP").upper():
            kind = "failed"
        counts[kind] += 1
        if kind == "failed":
            print(f"FAILED {Path(name).stem}: {case.get('name')}")
line = f"{counts['passed']} passed, {counts['failed']} failed"
print(line + (f", {counts['skipped']} skipped" if counts["skipped"] else ""))
sys.exit(0 if counts["passed"] > 0 and counts["failed"] == 0 else 1)
