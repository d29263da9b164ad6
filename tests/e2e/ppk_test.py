"""Carrier phases against a base from outside: the solution with its quality, what is refused, loose coupling fed with it."""
import csv
import gzip
import json
import math
import os
import random
import sys
from pathlib import Path

from program_test import check, main

BASE = [48.780735783, 9.171992250, 320.0]
ROVER = [48.780735783, 9.199262450, 320.0]


def data_of(source):
    folder = Path(os.environ.get("SCHULER_DATA", source.parent / "shared/data")) / "spirent_rtk_noatm"
    if not folder.is_dir():
        print(f"skipped: {folder} is not there (set SCHULER_DATA)")
        sys.exit(77)
    return folder


def described(program, name, data, rover="Rover-static-2km-east_MO_Spirent.obs.gz", base=None, more="", position=BASE, scheme="gnss"):
    """A data set of the generator's files; `base`: another file."""
    folder = Path(program.folder) / name
    folder.mkdir(exist_ok=True)
    (folder / "dataset.toml").write_text(f"""
[gnss]
observations = "{data}/{rover}"
navigation = ["{data}/RINEX_GN_Spirent.23N", "{data}/RINEX_EN_Spirent.23L"]
ionosphere = "none"
troposphere = "none"
[base]
observations = "{base or data / 'Base-static_MO_Spirent.obs.gz'}"
{f"position = {position}" if position else ""}
[filter]
scheme = "{scheme}"
{more}
""")
    return name


def rows_of(file):
    with open(file) as text:
        return list(csv.DictReader(text))


def metres(row, place):
    """North, east, up from a place."""
    return ((float(row["lat_deg"]) - place[0]) * 111_200.0, (float(row["lon_deg"]) - place[1]) * 111_320.0 * math.cos(math.radians(place[0])),
            float(row["height_m"]) - place[2])


def ppk_generator(program, source):
    """At rest two kilometres off: fixed from the first epoch, millimetres."""
    data = data_of(source)
    done = program("process", described(program, "static", data), "-o", "out", "--json")
    summary = json.loads(done.stdout)
    check(summary["carrier"] == {"epochs": 601, "fixed": 601, "float": 0, "single": 0}, f"{summary['carrier']}")
    rows = rows_of(Path(program.folder) / "out/solution.csv")
    check(len(rows) == 601 and all(row["q"] == "1" and int(row["satellites"]) >= 8 for row in rows), "the quality stands in solution.csv")
    largest = max(math.hypot(*metres(row, ROVER)) for row in rows)
    print(f"at rest, 2 km: {1e3 * largest:.2f} mm at most")
    check(largest < 0.005, f"{largest} m")
    carrier = rows_of(Path(program.folder) / "out/carrier.csv")
    check(len(carrier) == 601 and abs(float(carrier[0]["east_m"]) - 2004.4) < 1.0, f"the baseline: {carrier[0]}")
    program("process", "static", "-o", "float", "--json", "--set", "base.integers=false")
    rows = rows_of(Path(program.folder) / "float/solution.csv")
    check(all(row["q"] == "2" for row in rows), "without integers all is float")
    outside = [row for row in rows if any(abs(x) > 3.0 * float(row[std]) for x, std in zip(metres(row, ROVER), ("std_n_m", "std_e_m", "std_d_m")))]
    check(len(outside) <= 6, f"{len(outside)} of 601 outside three sigma")
    # the configuration that was used gives the same
    used = (Path(program.folder) / "out/config.toml").read_text()
    check("[base]" in used and "position = [48.780735783, 9.17199225, 320.0]" in used, "config.toml has the base")


def ppk_satellites(program, source):
    """`schuler gnss`: of a simulated drive with a tunnel; of the generator's rover against its base."""
    program("simulate", str(source / "examples/car-tight.toml"), "-o", "car")
    summary = json.loads(program("gnss", "car", "-o", "car-out", "--json").stdout)
    check(summary["status"] == {"solved": 310, "too few satellites": 90, "weak geometry": 0, "inconsistent ranges": 0}, f"{summary['status']}")
    check(0.5 < max(s["normalised_rms"] for s in summary["satellites"]) < 1.5, "residuals are not those of the sigmas")
    folder = Path(program.folder) / "car-out"
    rows, seen = rows_of(folder / "gnss.csv"), rows_of(folder / "satellites.csv")
    check(len(rows) == 400 and sum(row["q"] == "5" for row in rows) == 310, "epochs")
    times = {row["time_s"] for row in rows if row["q"] == "5"}
    used = {time: 0 for time in times}
    for row in seen:
        if row["used"] == "1":
            used[row["time_s"]] += 1
        check((row["used"] == "1") == (row["reason"] == ""), "a satellite is neither used nor is it said why")
    check(all(int(row["used"]) == used[row["time_s"]] for row in rows if row["q"] == "5"), "numbers of satellites differ")
    check("<svg" in (folder / "report.html").read_text(), "no plots")
    bad = program("gnss", "car", "-o", "car-out", "--start", "abs:5", status=2)
    check("run.start_s" in bad.stderr, bad.stderr)
    data = data_of(source)
    program("gnss", described(program, "views", data, rover="Rover-dynamic_MO_Spirent.obs.gz"), "-o", "views-out", "--quiet")
    folder = Path(program.folder) / "views-out"
    check(json.loads((folder / "summary.json").read_text())["carrier"]["fixed"] == 601, "not fixed")
    phases = [float(r["residual"]) for r in rows_of(folder / "residuals.csv") if r["quantity"] == "difference_phase_m" and r["whole"] == "1"]
    check(len(phases) > 5000 and math.sqrt(sum(x * x for x in phases) / len(phases)) < 0.003, "phases do not fit their integers")
    # A folder of raw measurements alone, and the scheme in a file of settings.
    bare = Path(program.folder) / "bare"
    bare.mkdir()
    for file in data.iterdir():
        if file.name.startswith("Rover-static") or file.name.startswith("RINEX_"):
            (bare / file.name).write_bytes(file.read_bytes())
    (Path(program.folder) / "scheme.toml").write_text('[filter]\nscheme = "gnss"\n')
    program("process", "bare", "--config", "scheme.toml", "-o", "bare-out", "--outputs", "summary")


def ppk_refusals(program, source):
    data = data_of(source)
    base = data / "Base-static_MO_Spirent.obs.gz"
    program.fails("process", described(program, "far", data, position=[48.781635783, 9.171992250, 320.0]), "-o", "o",
                  parts=["Base-static", "base.position", "100 m away", "[48.78073578, 9.17199225, 320.000]"])
    program.fails("process", described(program, "twice", data, base=data / "Rover-static-2km-east_MO_Spirent.obs.gz"), "-o", "o",
                  parts=["Rover-static", "base.observations", "rover's own log"])
    copied = Path(program.folder) / "copied.obs.gz"
    copied.write_bytes((data / "Rover-static-2km-east_MO_Spirent.obs.gz").read_bytes())
    program.fails("process", described(program, "copy", data, base=copied), "-o", "o", parts=["copied.obs.gz", "base.observations", "those of the rover"])
    program.fails("process", described(program, "moves", data, rover="Base-static_MO_Spirent.obs.gz",
                                       base=data / "Rover-dynamic_MO_Spirent.obs.gz"), "-o", "o", parts=["base.", "Rover-dynamic"])
    geonet = data.parent / "rtklib_geonet_pair/30400920.05o"
    if geonet.is_file():
        program.fails("process", described(program, "years", data, base=geonet), "-o", "o",
                      parts=["base.observations", "no time in common", "2005-04-0", "2023-01-08"])
    program.fails("process", described(program, "where", data, position=[400, 2, 3]), "-o", "o", parts=["dataset.toml", "base.position", "not a valid position on the Earth"])
    program.fails("process", described(program, "gone", data, base=Path(program.folder) / "gone.obs"), "-o", "o", parts=["gone.obs"])
    # a header in place of a position is told
    done = program("process", described(program, "header", data, base=base, position=None), "-o", "o")
    check("the position of the base is that stated in its log" in done.stderr, f"{done.stderr[-300:]}")


def ppk_loose(program, source):
    """An inertial unit at rest: loose coupling takes the fixes of carrier phases."""
    data = data_of(source)
    name = described(program, "loose", data, scheme="loose", more=f"""[imu]
file = "imu.csv"
grade = "mems"
axes = "frd"
[initial]
heading_deg = 30
""")
    draw = random.Random(5)
    rate, turn, gravity = 50, 7.292115e-5, 9.8091
    lat, heading = math.radians(ROVER[0]), math.radians(30.0)
    w = [turn * math.cos(lat) * math.cos(heading), -turn * math.cos(lat) * math.sin(heading), -turn * math.sin(lat)]
    with open(Path(program.folder) / name / "imu.csv", "w") as file:
        file.write("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n")
        for k in range(600 * rate):
            gyro = [x + draw.gauss(0.0, 6e-4) for x in w]
            force = [draw.gauss(0.0, 0.01), draw.gauss(0.0, 0.01), -gravity + draw.gauss(0.0, 0.01)]
            file.write(f"{1357207200.0 + k / rate:.3f}," + ",".join(f"{x:.8f}" for x in gyro + force) + "\n")
    done = program("process", name, "-o", "out", "--json", "--outage", "300:10")
    summary = json.loads(done.stdout)
    check(summary["carrier"]["fixed"] == 601, f"{summary['carrier']}")
    check(summary["gnss"]["rejected"] == 0 and summary["gnss"]["accepted"] > 500, f"{summary['gnss']}")
    rows = rows_of(Path(program.folder) / "out/solution.csv")
    late = [math.hypot(*metres(row, ROVER)) for row in rows if 1357207400.0 < float(row["time_s"]) < 1357207490.0]
    print(f"loose, at rest: {1e3 * max(late):.1f} mm at most")
    check(max(late) < 0.02, f"{max(late)} m")
    check((Path(program.folder) / "out/carrier.csv").is_file(), "carrier.csv is there too")
    told = program("process", name, "--scheme", "intermediate", "-o", "out", "--self-check", "off").stderr
    check("--scheme tight or loose uses them" in told, f"intermediate coupling does not use the base's phases: {told}")


def biased(source, target, bias, last_epoch):
    """A copy of a log whose ranges of each satellite are longer by what `bias` says, codes and phases alike, up to an epoch."""
    light, carriers = 299792458.0, {"1": 1575.42e6, "2": 1227.6e6, "5": 1176.45e6, "6": 1278.75e6, "7": 1207.14e6, "8": 1191.795e6}
    types, epochs, header = {}, 0, True
    with gzip.open(source, "rt") as log, open(target, "w") as out:
        for line in log:
            line = line.rstrip("\n")
            if header:
                if "SYS / # / OBS TYPES" in line:
                    types[line[0]] = line[6:60].split()
                header = "END OF HEADER" not in line
            elif line.startswith(">"):
                epochs += 1
            elif line[:1] in types:
                kept = line[:3]
                for k, kind in enumerate(types[line[0]]):
                    field = line[3 + 16 * k:19 + 16 * k].ljust(16)
                    if field[:14].strip() and kind[0] in "CL":
                        more = bias(line[:3]) / (1.0 if kind[0] == "C" else light / carriers[kind[1]])
                        field = f"{float(field[:14]) + more:14.3f}{field[14:]}"
                    kept += field
                line = kept.rstrip()
            if epochs > last_epoch:
                break
            out.write(line + "\n")


def ppk_tight(program, source):
    """The generator's figure with a simulated unit: ambiguities as states of the filter, three outages of twenty seconds."""
    data = data_of(source)
    folder = Path(program.folder)
    with open(data / "Rover-dynamic_motion_Spirent.csv", newline="") as file:
        next(file)
        motion = list(csv.DictReader(file))
    began = 1357207200.0
    with open(folder / "rose.csv", "w") as file:
        file.write("time_s,lat_deg,lon_deg,height_m,roll_deg,pitch_deg,heading_deg\n")
        for row in motion:
            lat, lon, heading = (math.degrees(float(row[key])) for key in ("Lat", "Long", "Heading"))
            file.write(f"{float(row['Time_ms']) / 1e3:.3f},{lat:.11f},{lon:.11f},{float(row['Height']):.4f},0,0,{heading:.6f}\n")
    (folder / "rose.toml").write_text('name = "rose"\nseed = 5\nduration_s = 590\n[trajectory]\ntype = "file"\nfile = "rose.csv"\n'
                                      '[imu]\nrate_hz = 50\ngrade = "mems"\n')
    program("simulate", "rose.toml", "-o", "simulated", "-q")
    name = described(program, "tight", data, rover="Rover-dynamic_MO_Spirent.obs.gz", scheme="tight",
                     more='[imu]\nfile = "imu.csv"\ngrade = "mems"\naxes = "frd"\n')
    with open(folder / "simulated/imu.csv") as rows, open(folder / name / "imu.csv", "w") as file:
        file.write(next(rows))
        for row in rows:
            time, rest = row.split(",", 1)
            file.write(f"{float(time) + began:.3f},{rest}")
    outages = [200.0, 320.0, 440.0]
    done = program("process", name, "-o", "out", "--json", "--smooth", "--self-check", "off",
                   *(word for start in outages for word in ("--outage", f"{start:.0f}:20")))
    check(json.loads(done.stdout)["ambiguities"]["held"] > 10_000, f"{done.stdout}")

    def errors(file):
        out = []
        for row in rows_of(folder / file):
            time = float(row["time_s"]) - began
            k = round(10.0 * time)
            if k >= len(motion) or abs(10.0 * time - k) > 1e-3:
                continue
            true = motion[k]
            off = metres(row, (math.degrees(float(true["Lat"])), math.degrees(float(true["Long"])), float(true["Height"])))
            out.append((time, math.sqrt(sum(x * x for x in off)),
                        any(abs(x) > 3.0 * float(row[std]) for x, std in zip(off, ("std_n_m", "std_e_m", "std_d_m")))))
        return out

    def judge(file, in_hole, elsewhere):
        all_errors = errors(file)
        inside = [e for t, e, _ in all_errors if any(start < t < start + 20.0 for start in outages)]
        rest = [e for t, e, _ in all_errors if t > 10.0 and not any(start < t < start + 23.0 for start in outages)]
        print(f"{file}: {1e3 * max(inside):.0f} mm in outages, else {1e3 * max(rest):.1f} mm")
        check(max(inside) < in_hole and max(rest) < elsewhere, f"{file}: {max(inside)}, {max(rest)} m")
        check(sum(out for _, _, out in all_errors) < 0.01 * len(all_errors), f"{file}: within three sigma")

    judge("out/solution.csv", 0.1, 0.015)
    program("process", name, "-o", "forward", "--self-check", "off", *(word for start in outages for word in ("--outage", f"{start:.0f}:20")))
    judge("forward/solution.csv", 1.0, 0.03)
    phases = rows_of(folder / "forward/ambiguities.csv")
    first = next(float(row["time_s"]) - began for row in phases if int(row["held"]) > 0)
    check(first < 10.0, f"integers from {first} s on")
    for start in outages:
        again = next(float(row["time_s"]) - began for row in phases if float(row["time_s"]) > began + start + 19.0 and int(row["held"]) > 0)
        check(again < start + 22.5, f"after the outage at {start} s integers at {again} s")

    # a base that falls silent, and single-point fixes off by metres that do not change: they are no thousand measurements
    ranges = random.Random(4)
    errors_of_ranges = {}
    for file, last in (("Rover-dynamic_MO_Spirent.obs.gz", 10 ** 6), ("Base-static_MO_Spirent.obs.gz", 300)):
        biased(data / file, folder / name / file.replace(".gz", ""), lambda s: errors_of_ranges.setdefault(s, abs(ranges.gauss(0.0, 3.0))), last)
    toml = (folder / name / "dataset.toml").read_text()
    (folder / name / "dataset.toml").write_text(toml.replace(".obs.gz", ".obs").replace(f"{data}/Rover", "Rover").replace(f"{data}/Base", "Base"))
    program("process", name, "-o", "silent", "--scheme", "loose")
    late = [(e, out) for t, e, out in errors("silent/solution.csv") if t > 335.0]
    print(f"after the base: {max(e for e, _ in late):.2f} m, {sum(out for _, out in late)} of {len(late)} outside three sigma")
    check(max(e for e, _ in late) < 1.0 and sum(out for _, out in late) < 0.01 * len(late), "a silent base")


if __name__ == "__main__":
    main({"ppk_generator": ppk_generator, "ppk_refusals": ppk_refusals, "ppk_loose": ppk_loose, "ppk_tight": ppk_tight, "ppk_satellites": ppk_satellites})
