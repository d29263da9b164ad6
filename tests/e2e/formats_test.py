"""One drive in the formats that people have: recognised, processed to the same solution, converted and read back; what is damaged is refused."""
import csv
import json
import math
import struct
from pathlib import Path

from heard_test import run
from program_test import check, main

DRIVE = """
name = "drive"
duration_s = 150
reference_rate_hz = 10
[trajectory]
type = "car"
start = { lat_deg = 48.1, lon_deg = 11.5, height_m = 500 }
standstill_s = 25
[imu]
rate_hz = 100
grade = "tactical"
[gnss]
rate_hz = 5
white_m = [0.05, 0.05, 0.1]
white_velocity_m_s = [0.02, 0.02, 0.03]
"""
START_S = 100.0   # of the autopilots' clocks
IMU = ("gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2")


def rows_of(path):
    with open(path, newline="") as file:
        return [{key: float(value) for key, value in row.items() if value.replace(".", "").replace("-", "").replace("e", "").isdigit()} for row in csv.DictReader(file)]


def ulog(imu, gnss):
    def message(kind, body):
        return struct.pack("<Hc", len(body), kind) + body

    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + message(b"B", bytes(40))
    out += message(b"F", b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;")
    out += message(b"F", b"vehicle_gps_position:uint64_t timestamp;double latitude_deg;double longitude_deg;double altitude_msl_m;double altitude_ellipsoid_m;"
                         b"float s_variance_m_s;float eph;float epv;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t fix_type;")
    out += message(b"F", b"vehicle_rates_setpoint:uint64_t timestamp;float roll;float pitch;float yaw;")
    for number, topic in enumerate((b"sensor_combined", b"vehicle_gps_position", b"vehicle_rates_setpoint")):
        out += message(b"A", b"\0" + struct.pack("<H", number) + topic)
    us = lambda row: round((row["time_s"] + START_S) * 1e6)
    events = [(us(r), message(b"D", struct.pack("<HQ6f", 0, us(r), *[r[n] for n in IMU]))) for r in imu]
    events += [(us(r), message(b"D", struct.pack("<HQ4d6fB", 1, us(r), r["lat_deg"], r["lon_deg"], r["height_m"] - 47, r["height_m"], 0.02 * 3 ** .5, 0.05 * 2 ** .5, 0.1,
                                                 r["vel_n_m_s"], r["vel_e_m_s"], r["vel_d_m_s"], 6))) for r in gnss]
    return out + b"".join(e for _, e in sorted(events, key=lambda e: e[0]))


def dataflash(imu, gnss):
    def define(kind, name, types, columns, size):
        return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", kind, size + 3, name, types, columns)

    out = define(1, b"IMU", b"QBffffff", b"TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", 33)
    out += define(2, b"GPS", b"QBBLLefff", b"TimeUS,I,Status,Lat,Lng,Alt,Spd,GCrs,VZ", 34) + define(3, b"GPA", b"QBCCC", b"TimeUS,I,HAcc,VAcc,SAcc", 15)
    us = lambda row: round((row["time_s"] + START_S) * 1e6)
    events = [(us(r), b"\xa3\x95\x01" + struct.pack("<QB6f", us(r), 0, *[r[n] for n in IMU])) for r in imu]
    for r in gnss:
        speed, course = (r["vel_n_m_s"] ** 2 + r["vel_e_m_s"] ** 2) ** .5, math.degrees(math.atan2(r["vel_e_m_s"], r["vel_n_m_s"])) % 360
        events.append((us(r), b"\xa3\x95\x02" + struct.pack("<QBBiiifff", us(r), 0, 6, round(r["lat_deg"] * 1e7), round(r["lon_deg"] * 1e7), round(r["height_m"] * 100), speed,
                                                            course, r["vel_d_m_s"]) + b"\xa3\x95\x03" + struct.pack("<QBHHH", us(r), 0, 7, 10, 3)))
    return out + b"".join(e for _, e in sorted(events, key=lambda e: e[0]))


def mcap(imu, gnss):
    text = lambda value: struct.pack("<I", len(value)) + value
    record = lambda op, body: struct.pack("<BQ", op, len(body)) + body

    def header(row, frame):
        ns = round((row["time_s"] + 1_700_000_000) * 1e3) * 1_000_000
        out = b"\0\1\0\0" + struct.pack("<II", ns // 10**9, ns % 10**9) + text(frame + b"\0")
        return ns, out

    def padded(out, size):
        return out + bytes(-(len(out) - 4) % size)

    out = b"\x89MCAP0\r\n" + record(1, text(b"ros2") + text(b""))
    for number, topic, kind in ((1, b"/imu", b"sensor_msgs/msg/Imu"), (2, b"/fix", b"sensor_msgs/msg/NavSatFix")):
        out += record(3, struct.pack("<H", number) + text(kind) + text(b"ros2msg") + text(b"")) + record(4, struct.pack("<HH", number, number) + text(topic) + text(b"cdr") + struct.pack("<I", 0))
    events = []
    for r in imu:
        ns, m = header(r, b"imu")
        m = padded(m, 8) + struct.pack("<4d", 0, 0, 0, 1) + bytes(72) + struct.pack("<3d", *[r[n] for n in IMU[:3]]) + bytes(72) + struct.pack("<3d", *[r[n] for n in IMU[3:]]) + bytes(72)
        events.append((ns, record(5, struct.pack("<HIQQ", 1, 0, ns, ns) + m)))
    for r in gnss:
        ns, m = header(r, b"gps")
        m = padded(m + b"\0", 2) + struct.pack("<H", 1)
        m = padded(m, 8) + struct.pack("<3d", r["lat_deg"], r["lon_deg"], r["height_m"]) + struct.pack("<9d", .0025, 0, 0, 0, .0025, 0, 0, 0, .01) + b"\2"
        events.append((ns, record(5, struct.pack("<HIQQ", 2, 0, ns, ns) + m)))
    return out + b"".join(e for _, e in sorted(events, key=lambda e: e[0])) + record(15, bytes(4))


def horizontal_rms(program, solution, shift):
    """Against the simulated truth, whose times are those of the drive."""
    truth = {round(r["time_s"], 3): r for r in rows_of(Path(program.folder) / "drive/reference.csv")}
    squares = []
    for r in rows_of(solution):
        t = truth.get(round(r["time_s"] - shift, 3))
        if t is not None and t["time_s"] > 60:
            squares.append(((r["lat_deg"] - t["lat_deg"]) * 111e3) ** 2 + ((r["lon_deg"] - t["lon_deg"]) * 74e3) ** 2)
    check(len(squares) > 500, f"{solution}: only {len(squares)} epochs at times of the truth")
    return (sum(squares) / len(squares)) ** .5


def formats(program, source):
    folder = Path(program.folder)
    (folder / "drive.toml").write_text(DRIVE)
    program("simulate", "drive.toml", "-o", "drive", "-q")
    imu, gnss = rows_of(folder / "drive/imu.csv"), rows_of(folder / "drive/gnss.csv")
    for r in imu:   # the simulator writes increments over 10 ms
        r.update({f"gyro_{a}_rad_s": 100 * r[f"dtheta_{a}_rad"] for a in "xyz"} | {f"accel_{a}_m_s2": 100 * r[f"dv_{a}_m_s"] for a in "xyz"})
    # the same drive in each
    (folder / "a.ulg").write_bytes(ulog(imu, gnss))
    (folder / "a.bin").write_bytes(dataflash(imu, gnss))
    (folder / "a.mcap").write_bytes(mcap(imu, gnss))
    for name, shift, bound in (("a.ulg", START_S, 0.15), ("a.bin", START_S, 0.2), ("a.mcap", 1_700_000_000, 0.25)):
        found = json.loads(program("inspect", name, "--json").stdout)
        kinds = {f["path"]: f["kind"] for f in found["files"]}
        check(kinds == {f"{name}#imu": "imu", f"{name}#gnss": "gnss"}, f"{name}: {kinds}")
        provided = [f["provides"] for f in found["files"]]
        check(sorted(provided) == [["fixes"], ["imu"]], f"{name}: {provided}")
        check(f'file = "{name}#imu"' in found["dataset_toml"], f"{name}: the draft names the stream")
        program("process", name, "-o", f"out_{name}", "-q")
        rms = horizontal_rms(program, folder / f"out_{name}/solution.csv", shift)
        check(rms < bound, f"{name}: {rms:.3f} m horizontally")
    # a described data set with streams of a log, and a folder that holds nothing but a folder
    (folder / "set").mkdir()
    (folder / "a.ulg").rename(folder / "set/a.ulg")
    (folder / "set/dataset.toml").write_text('[imu]\nfile = "a.ulg#imu"\n[gnss]\nfile = "a.ulg#gnss"\n')
    program("process", "set", "-o", "out_set", "-q")
    check(horizontal_rms(program, folder / "out_set/solution.csv", START_S) < 0.15, "a data set of streams")
    deeper = folder / "top/recording"
    deeper.mkdir(parents=True)
    (deeper / "log.bin").write_bytes((folder / "a.bin").read_bytes())
    check("recording/log.bin#imu" in program("inspect", "top").stdout, "one folder deeper")
    program("process", "top", "-o", "out_top", "-q")

    # every format that is written, from the result and back
    for name in ("track.gpx", "track.sbet", "track.tum", "track.euroc", "track.pos", "track.nmea", "track.mat", "track.h5", "track.mcap", "track.geojson", "track.kml", "track.csv"):
        program("convert", "out_a.mcap/run.h5", name)
        check((folder / name).stat().st_size > 1000, f"{name} is written")
    for name in ("track.gpx", "track.sbet", "track.tum", "track.pos", "track.mat", "track.h5", "track.mcap"):
        program("convert", name, "again.csv")
        back, once = rows_of(folder / "again.csv"), rows_of(folder / "out_a.mcap/solution.csv")
        check(len(back) == len(once), f"{name}: {len(back)} of {len(once)} rows")
        worst = max(abs(a["lat_deg"] - b["lat_deg"]) + abs(a["lon_deg"] - b["lon_deg"]) for a, b in zip(back, once))
        check(worst < 2e-10 or (name == "track.tum" and worst < 3e-11 * 1e3), f"{name}: {worst} deg")
    program("convert", "a.bin", "tables")
    check(sorted(p.name for p in (folder / "tables").glob("*.csv")) == ["gnss.csv", "imu.csv"], "every stream as a table")
    program("convert", "a.bin#imu", "one.csv")
    check((folder / "one.csv").read_bytes() == (folder / "tables/imu.csv").read_bytes(), "one stream as a table")

    listed = program("help", "formats").stdout
    check(all(word in listed for word in ("ulog", "dataflash", "mcap", "novatel", "sbet", "geojson")), "help formats")
    check("gyro_x_rad_s <- gyro_x_rad_s" in program("inspect", "a.bin", "--explain").stdout, "--explain")

    program("inspect", "a.bin", "-o", "found")
    page = (folder / "found/report.html").read_text()
    check(all(text in page for text in ("a.bin#imu: imu,", "a.bin#gnss: gnss,", "track of the fixes", "when each stream has data", "gyro_x_rad_s")), "inspect as a picture")

    # damage
    for name in ("a.bin", "a.mcap", "set/a.ulg"):
        whole = (folder / name).read_bytes()
        for cut in (len(whole) // 2, 40, 9):
            file = folder / ("cut" + Path(name).suffix)
            file.write_bytes(whole[:cut])
            done = run(program, "process", file.name, "-o", "out_cut", "-q")
            check(done.returncode == 0 if cut > 1000 else done.returncode == 2, f"{name} cut to {cut}: status {done.returncode}, {done.stderr}")
            check(done.returncode == 0 or file.name in done.stderr, f"{name} cut to {cut}: {done.stderr}")
    (folder / "foreign.ulg").write_bytes(b"\x7fELF" + bytes(range(256)) * 20)
    for arguments in (("process", "foreign.ulg", "-o", "x"), ("convert", "foreign.ulg", "x.csv"), ("convert", "a.bin#imu9", "x.csv"), ("convert", "a.bin", "x.xyz"), ("convert", "a.bin#imu", "x.gpx")):
        program.fails(*arguments)


if __name__ == "__main__":
    main({"formats": formats})
