"""Ranges from outside: the triad of paper D, schemes with few satellites, stations from a receiver's log."""
import json
from pathlib import Path

from program_test import check, main


def ranges_triad(program, source):
    """The study stands beside its reference, does not depend on --jobs, and refuses what it does not know."""
    done = json.loads(program("analyze", "triad", "--cases", "ce", "--baro", 30, "-n", 6, "--json").stdout)
    row = {r["key"]: r for r in done["rows"]}
    check(list(row) == ["c", "e"], f"cases: {list(row)}")
    check(abs(row["c"]["reference"]["pooled"] - 32.12) < 0.01, f"reference of case c: {row['c']['reference']}")
    check(done["ratio_c_e_at_600_s"] > 2, f"two stations replace two satellites: {done['ratio_c_e_at_600_s']}")
    for jobs in (1, 2):
        program("analyze", "triad", "--cases", "s", "-n", 3, "--jobs", jobs, "-o", f"triad{jobs}", "-q")
    for name in ("triad.csv", "course.csv", "summary.json", "report.html"):
        one, two = ((Path(program.folder) / f"triad{jobs}" / name).read_bytes() for jobs in (1, 2))
        check(one == two, f"{name} does not depend on --jobs")
    course = (Path(program.folder) / "triad1/course.csv").read_text().splitlines()
    check(len(course) == 602, f"a row a second: {len(course)}")
    check(float(course[302 + 60].split(",")[1]) < float(course[301].split(",")[1]), "the stations that come on help")
    for option, value in {"--cases": "az", "--grade": "toy", "--oscillator": "quartz", "--baro": "-3", "--mechanization": "polar"}.items():
        program.fails("analyze", "triad", option, value, parts=[option])


if __name__ == "__main__":
    main({"ranges_triad": ranges_triad})
