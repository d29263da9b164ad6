"""Logs as strangers have them: columns of other units, logs in parts, files that nobody asked for. What is not used is told."""
import csv
import json
import subprocess
from pathlib import Path

from facts_test import facts_of, rms, simulated, summary_of
from program_test import check, main

OUTAGES = ["--outage", "60:10,85:10,110:10", "--outputs", "summary"]


def table_of(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def write_table(path, header, rows):
    path.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n")


def strangers_velocity(program, source):
    """Velocities in another unit, order or sign: found, used, told; as good as the log as it was."""
    folder = Path(program.folder)
    simulated(program, folder)
    log = folder / "logs/gnss.csv"
    header, rows = table_of(log)
    bare = rms(summary_of(program, "logs", "-o", "bare", *OUTAGES)["outages"])
    places = [header.index(name) for name in ("vel_n_m_s", "vel_e_m_s", "vel_d_m_s")]
    cases = {"kilometres per hour": lambda n, e, d: (3.6 * n, 3.6 * e, 3.6 * d),
             "millimetres per second": lambda n, e, d: (1e3 * n, 1e3 * e, 1e3 * d),
             "exchanged": lambda n, e, d: (e, n, d),
             "reversed": lambda n, e, d: (-n, -e, -d)}
    for name, change in cases.items():
        changed = [list(row) for row in rows]
        for row in changed:
            for place, value in zip(places, change(*(float(row[place]) for place in places))):
                row[place] = repr(value)
        write_table(log, header, changed)
        summary = summary_of(program, "logs", "-o", name, *OUTAGES)
        got = rms(summary["outages"])
        check(got < 1.1 * bare + 0.05, f"{name}: {got:.3f} m, as they were {bare:.3f} m")
        check(any("velocities do not agree with the positions" in text for text in summary["warnings"]), f"{name}: {summary['warnings']}")
        key = "gnss.columns" if name == "exchanged" else "gnss.scale"
        check(facts_of(summary)[key]["how"] == "found", f"{name}: {key} is found")
    for row, original in zip(changed, rows):
        for place in places:
            row[place] = repr(float(original[place]) / 0.7)
    write_table(log, header, changed)
    summary = summary_of(program, "logs", "-o", "odd", *OUTAGES[:2])
    check(facts_of(summary)["gnss.use_velocity"]["value"] is False, "velocities of no unit are not used")
    check(any("any known unit" in text for text in summary["warnings"]), f"{summary['warnings']}")
    got = rms(summary["outages"])
    check(got < 3.0 * bare + 0.5, f"with positions alone: {got:.3f} m, with velocities {bare:.3f} m")
    again = summary_of(program, "logs", "-o", "again", *OUTAGES, "--config", "odd/config.toml")
    check(rms(again["outages"]) == got and not any(entry["key"].startswith("gnss.") for entry in again["ignored"]),
          f"the run repeats: {again['ignored']}")
    write_table(log, header, [[repr(3.6 * float(v)) if i in places else v for i, v in enumerate(row)] for row in rows])
    given = ["--set", "gnss.scale={vel_n_m_s=1,vel_e_m_s=1,vel_d_m_s=1}"]
    done = subprocess.run([program.path, "process", "logs", "-o", "given", *OUTAGES, *given, "--json"], cwd=folder, capture_output=True, check=False)
    check(done.returncode == 1, f"given and wrong: the result is refused, exit status {done.returncode}")
    summary = json.loads(done.stdout)
    check(any("contradict gnss.scale" in text and "km/h" in text for text in summary["warnings"]), f"given and wrong: {summary['warnings']}")


if __name__ == "__main__":
    main({"strangers_velocity": strangers_velocity})
