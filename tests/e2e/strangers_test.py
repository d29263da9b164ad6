"""Logs as strangers have them: columns of other units, logs in parts, files that nobody asked for. What is not used is told."""
import csv
import datetime
import json
import random
import shutil
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


def strangers_shaken(program, source):
    """Ten seconds in which an IMU is shaken, on a course flown again and again: its clock is left alone."""
    folder = Path(program.folder)
    noise = random.Random(5)
    for seed, part in ((1, 0.8), (2, 0.2), (4, 0.8), (5, 0.2)):
        (folder / "flight.toml").write_text(
            f'name = "flight"\nseed = {seed}\nduration_s = 400\n[trajectory]\ntype = "figure8"\nlength_m = 800\n'
            'start = { lat_deg = 48.1, lon_deg = 11.5, height_m = 500 }\n[imu]\nrate_hz = 100\nkind = "rates"\ngrade = "consumer"\n'
            "[gnss]\nrate_hz = 1\n")
        program("simulate", "flight.toml", "-o", f"flight{seed}", "-q")
        shaken = folder / f"shaken{seed}"
        shaken.mkdir()
        shutil.copy(folder / f"flight{seed}/gnss.csv", shaken)
        header, rows = table_of(folder / f"flight{seed}/imu.csv")
        begin = float(rows[0][0]) + part * 400.0
        for row in rows:
            if begin <= float(row[0]) < begin + 10.0:
                for k, name in enumerate(header):
                    if name.startswith(("gyro", "accel")):
                        row[k] = repr(float(row[k]) + noise.gauss(0.0, 3.0 if name.startswith("gyro") else 60.0))
        write_table(shaken / "imu.csv", header, rows)
        told = program("inspect", f"shaken{seed}").stdout
        check("the clocks of" not in told, f"seed {seed}: {told}")


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
    summary = json.loads(done.stdout)
    # the verdict names it in any case; what is not refused is inside its sigmas
    told = any("contradict gnss.scale" in reason for reason in summary["verdict"]["reasons"])
    inside = all(outage["inside_3sigma"] for outage in summary["outages"])
    check(done.returncode == 1 or (told and inside), f"given and wrong: exit status {done.returncode}, {summary['verdict']}, {summary['outages']}")
    check(any("contradict gnss.scale" in text and "km/h" in text for text in summary["warnings"]), f"given and wrong: {summary['warnings']}")


def warned(summary, *parts):
    check(any(all(part in text for part in parts) for text in summary["warnings"]), f"{parts}: {summary['warnings']}")


def strangers_tables(program, source):
    """Tables of other programs are read as what they are, with the result of the plain ones."""
    folder = Path(program.folder)
    simulated(program, folder)
    imu_header, imu = table_of(folder / "logs/imu.csv")
    gnss_header, gnss = table_of(folder / "logs/gnss.csv")
    bare = rms(summary_of(program, "logs", "-o", "bare", *OUTAGES)["outages"])
    began = datetime.datetime(2024, 5, 13, 11, 58, 30)

    def clock(row):
        return (began + datetime.timedelta(seconds=float(row[0]))).strftime("%m/%d/%Y %I:%M:%S.%f %p")

    def minutes(degrees):
        whole = int(float(degrees))
        return f"{whole * 100 + (float(degrees) - whole) * 60:.8f}"

    def logs(name, imu_rows, gnss_rows, preamble="", encoding="utf-8", header=gnss_header):
        (folder / name).mkdir()
        for file, names, rows in (("imu.csv", imu_header, imu_rows), ("gnss.csv", header, gnss_rows)):
            text = preamble + "\n".join(",".join(row) for row in [names, *rows]) + "\n"
            (folder / name / file).write_text(text, encoding=encoding)

    logs("preamble", imu, gnss, preamble="Logger v2.3\nStart: 2024-05-13 11:58\nDevice,X\n")
    logs("utf16", imu, gnss, encoding="utf-16")
    logs("halves", [[clock(row), *row[1:]] for row in imu], [[clock(row), *row[1:]] for row in gnss])
    logs("minutes", imu, [[row[0], minutes(row[1]), minutes(row[2]), *row[3:]] for row in gnss],
         header=[gnss_header[0], "latitude", "longitude", *gnss_header[3:]])
    for held in (False, True):
        table, at = [], 0
        for row in imu:
            fresh = False
            while at + 1 < len(gnss) and float(gnss[at + 1][0]) <= float(row[0]) + 1e-9:
                at, fresh = at + 1, True
            table.append(row + (gnss[at][1:] if held or fresh else [""] * len(gnss[at][1:])))
        name = "held" if held else "blank"
        (folder / name).mkdir()
        write_table(folder / name / "log.csv", imu_header + gnss_header[1:], table)
    for name in ("preamble", "utf16", "halves", "minutes", "blank", "held"):
        got = rms(summary_of(program, name, "-o", f"{name}_out", *OUTAGES)["outages"])
        check(got < 1.3 * bare + 0.1, f"{name}: {got:.3f} m, plain {bare:.3f} m")

    # a telephone's tables: rates and accelerations, 3 ms apart, of the same increments
    (folder / "phone").mkdir()
    step = float(imu[1][0]) - float(imu[0][0])
    for file, first, late in (("Gyroscope.csv", 1, 0.0), ("Accelerometer.csv", 4, 0.003)):
        rows = [[f"{float(row[0]) - 0.5 * step + late:.4f}", *(f"{float(row[first + axis]) / step:.9f}" for axis in (2, 1, 0))] for row in imu]
        write_table(folder / "phone" / file, ["seconds_elapsed", "z", "y", "x"], rows)
    write_table(folder / "phone/gnss.csv", gnss_header, gnss)
    summary = summary_of(program, "phone", "-o", "phone_out", *OUTAGES)
    got = rms(summary["outages"])
    check(facts_of(summary)["imu.file"]["value"] == "Gyroscope.csv#imu", "both tables are one log")
    check(got < 3.0 * bare + 1.0, f"telephone: {got:.3f} m, plain {bare:.3f} m")


def strangers_told(program, source):
    """What is given or lies in the folder and has no effect is told."""
    folder = Path(program.folder)
    simulated(program, folder)
    header, rows = table_of(folder / "logs/imu.csv")
    summary = summary_of(program, "logs", "-o", "outage", "--outage", "5000:10", "--set", 'gnss.fix_codes={"9"="none"}', "--outputs", "summary")
    warned(summary, "the outage of 10 s at 5000 s has no effect")
    warned(summary, "gnss.fix_codes: 9 does not occur in gnss.csv")
    shutil.copytree(folder / "logs", folder / "logs_whole")
    (folder / "logs/imu.csv").unlink()
    write_table(folder / "logs/imu_1.csv", header, rows[:len(rows) // 2])
    write_table(folder / "logs/imu_2.csv", header, rows[len(rows) // 2:])
    whole, parts = summary_of(program, "logs_whole", "-o", "whole"), summary_of(program, "logs", "-o", "parts")
    check(facts_of(parts)["imu.parts"]["value"] == ["imu_2.csv"], "the parts of a log are joined")
    table = [(folder / name / "solution.csv").read_bytes() for name in ("whole", "parts")]
    check(table[0] == table[1] and whole["facts"] != parts["facts"], "the solution is that of the whole log")
    serial = folder / "serial"
    serial.mkdir()
    for name in ("imu_1.csv", "gnss.csv"):
        header, rows = table_of(folder / "logs" / name)
        write_table(serial / name, header, [[f"{45413 + (43000 + float(row[0])) / 86400:.10f}", *row[1:]] for row in rows])
    program.fails("process", "serial", "-o", "x", parts=["serial dates of a spreadsheet", "86400"])


def strangers_left_out(program, source):
    """What was found and cannot be read is left out and told; what was named stops the run. First rows without values cost themselves."""
    folder = Path(program.folder)
    simulated(program, folder)
    header, rows = table_of(folder / "logs/imu.csv")
    gnss_header, gnss = table_of(folder / "logs/gnss.csv")
    (folder / "bare").mkdir()
    late = [[row[0], *["nan"] * 6] if i < 3 else row for i, row in enumerate(rows)]
    dated = [[f"{200000 + float(row[0]):.4f}", *row[1:], "2244"] for row in late]
    write_table(folder / "bare/imu.csv", ["gps_sow_s", *header[1:], "gps_week"], dated)
    write_table(folder / "bare/gnss.csv", gnss_header, [[f"{200000 + float(row[0]):.4f}", *row[1:]] for row in gnss])
    without = summary_of(program, "bare", "-o", "without")
    warned(without, "imu.csv", "rows skipped because a value is missing", "line 2", "(3 times)")
    check(facts_of(without)["time.week"]["value"] == 2244, f"the week beside the seconds: {facts_of(without).get('time.week')}")
    first = table_of(folder / "without/solution.csv")[1][0]
    check(float(first[0]) > 0, f"the solution has rows: {first}")
    pressures = [[gnss_row[0], "" if i % 3 == 1 else str(95000 + i % 7)] for i, gnss_row in enumerate(table_of(folder / "bare/gnss.csv")[1])]
    write_table(folder / "bare/baro.csv", ["time_s", "pressure_pa"], pressures)
    found = summary_of(program, "bare", "-o", "found")
    warned(found, "baro.csv was found and is left out", "baro.csv:3", "pressure_pa", "[baro] file = ")
    check("baro.file" not in facts_of(found), "a file that is left out is no fact of the run")
    solutions = [(folder / name / "solution.csv").read_bytes() for name in ("without", "found")]
    check(solutions[0] == solutions[1], "the run is that without the file")
    again = summary_of(program, "bare", "-o", "again", "--config", "found/config.toml")
    check((folder / "again/solution.csv").read_bytes() == solutions[1] and again is not None, "the dumped settings repeat it")
    (folder / "bare/dataset.toml").write_text('[imu]\nfile = "imu.csv"\n[gnss]\nfile = "gnss.csv"\n[baro]\nfile = "baro.csv"\n')
    program.fails("process", "bare", "-o", "named", parts=["baro.csv:3", "pressure_pa"])


if __name__ == "__main__":
    main({"strangers_shaken": strangers_shaken, "strangers_velocity": strangers_velocity, "strangers_tables": strangers_tables, "strangers_told": strangers_told,
          "strangers_left_out": strangers_left_out})
