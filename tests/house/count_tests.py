"""scripts/count_tests.py: counts, exit status, and the slowest tests.

    count_tests.py ROOT
"""
import subprocess
import sys
import tempfile
from pathlib import Path

SCRIPT = Path(sys.argv[1]) / "scripts/count_tests.py"
failures = []


def counted(cases, *options):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "release.xml"
        file.write_text("<testsuite>" + "".join(f'<testcase name="{name}" status="{status}" time="{time}">{inner}</testcase>'
                                                for name, status, time, inner in cases) + "</testsuite>")
        done = subprocess.run([sys.executable, SCRIPT, *options, file], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


def check(true, text):
    if not true:
        failures.append(text)


run = [(f"t{i}", "run", 0.1 * i, "") for i in range(30)]
status, said = counted(run)
check(status == 0 and said == "30 passed, 0 failed\n", f"all pass: {status} {said}")
status, said = counted(run + [("bad", "fail", 9.0, "")])
check(status == 1 and said.splitlines() == ["FAILED release: bad", "30 passed, 1 failed"], f"one fails: {status} {said}")
status, said = counted(run + [("left out", "notrun", 0.0, '<skipped message="SKIP_RETURN_CODE=77"/>'), ("gone", "notrun", 0.0, '<skipped message="Unable to find executable"/>')])
check(status == 1 and said.endswith("30 passed, 1 failed, 1 skipped\n"), f"a missing program is a failure: {status} {said}")
check(counted([])[0] == 1, "nothing has passed")
status, said = counted(run + [("long", "run", 77.5, "")], "--slowest", "20")
lines = said.splitlines()
check(status == 0 and len(lines) == 22 and lines[0].startswith("the slowest of 31 tests") and lines[1].split() == ["77.5", "release:", "long"]
      and lines[2].split()[-1] == "t29" and lines[-1] == "31 passed, 0 failed", f"the slowest: {said}")
print("\n".join(failures) or "good")
sys.exit(1 if failures else 0)
