"""Seeds of fuzz_files, fuzz_live and fuzz_forms: the first bytes choose the reader."""
import json
import struct
import zlib

import seeds_binary
import seeds_containers


def nmea(body):
    check = 0
    for byte in body.encode():
        check ^= byte
    return f"${body}*{check:02X}\r\n".encode()


def mat():
    """Version 5, not compressed: columns of docs/files.md."""
    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)

    def column(name, values):
        body = element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack("<ii", len(values), 1)) + element(1, name.encode())
        return element(14, body + element(9, struct.pack(f"<{len(values)}d", *values)))

    columns = {"time_s": [0, 1, 2], "lat_deg": [48, 48, 48.1], "lon_deg": [11, 11, 11.1], "height_m": [500, 501, 502]}
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"".join(column(name, values) for name, values in columns.items())


def gz(data):
    """Stored, so that the bytes are those of any library."""
    body = b"\x01" + struct.pack("<HH", len(data), len(data) ^ 0xFFFF) + data
    return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + body + struct.pack("<II", zlib.crc32(data), len(data))


def files():
    imu = b"timestamp,x,y,z\n" + b"".join(b"%d,0.1,0.2,%d\n" % (10**9 + 10**7 * i, 9 + i % 2) for i in range(12))
    oxts = b" ".join(b"%d" % (i + 1) for i in range(30)) + b"\n"
    table = {"grid": (5, b"lat_deg,lon_deg,up_mgal\n48,11,1\n48,12,2\n49,11,3\n49,12,4\n"),
             "events": (6, b"time_s,name\n1.5,photo 1\n2.5,photo 2\n"), "gauges": (7, b"time_s,height_1_m\n1,-3\n2,-3.5\n"),
             "velocities": (8, b"time_s,vel_forward_m_s,vel_right_m_s,vel_down_m_s\n1,2,0,0\n2,2,0,0\n"), "compass": (9, b"time_s,heading_deg\n1,45\n2,46\n"),
             "odometer": (10, b"time_s,speed_m_s\n1,12\n2,12.5\n")}
    return {"mat": b"\x01" + mat(), "kitti": b"\x03" + b"\xfe".join([b"2011-09-26 13:02:25.594360375\n2011-09-26 13:02:25.604306320\n", oxts, oxts]),
            "phone": b"\x04" + b"\xfe".join([imu.replace(b"9", b"0"), imu, imu]), "recording": b"\x0b" + bytes((37 * i * i + 11 * i) % 251 for i in range(600)),
            "gz": b"\x0c" + gz(imu), "text": b"\x0d" + imu, "raw": b"\x0e" + seeds_binary.ubx_log(), "any": b"\x0f" + seeds_containers.seeds()["gpx"][1:],
            **{name: bytes([kind]) + content for name, (kind, content) in table.items()}}


def live():
    """Format, instrument, bytes a piece."""
    lines = [{"type": "imu", "time_ns": 1000010000000, "gyro_rad_s": [0, 0, 0], "accel_m_s2": [0, 0, -9.81]},
             {"type": "gnss", "time_s": 1000.2, "lat_deg": 48.1, "lon_deg": 11.5, "height_m": 520, "velocity_m_s": [0, 0, 0], "std_m": [1, 1, 2], "satellites": 9},
             {"type": "gauges", "time_s": 1000.2, "height_m": [-12.4, -12.9]}, {"type": "log", "time_s": 1000.2, "velocity_m_s": [2.1, 0.02, -0.1]},
             {"type": "mag", "time_s": 1000.2, "field_t": [2e-5, 0, 4e-5]}, {"type": "baro", "time_s": 1000.2, "height_m": 521}]
    tpv = {"class": "TPV", "mode": 3, "time": "2024-05-01T12:00:00.000Z", "lat": 48.1, "lon": 11.5, "altHAE": 500.0, "epx": 1.0, "epy": 1.0, "epv": 2.0}
    sky = {"class": "SKY", "satellites": [{"PRN": 5, "gnssid": 0, "svid": 5, "el": 30.0, "az": 120.0, "ss": 44.0, "used": True}]}
    text = lambda objects: "".join(json.dumps(o) + "\n" for o in objects).encode()
    sentences = b"".join(map(nmea, ["GNRMC,120000.00,A,4800.0000,N,01100.0000,E,1.00,90.00,010524,,,A", "GNGGA,120000.00,4800.0000,N,01100.0000,E,1,9,1.0,500.0,M,47.0,M,,",
                                    "GNGSA,A,3,05,,,,,,,,,,,,1.2,0.9,0.8,1", "GPGSV,1,1,02,05,30,120,44,12,,,20,1", "GNGST,120000.00,1,1,1,0,1,1,2"]))
    return {"nmea": b"\0\x01\x40" + sentences * 2, "ubx": b"\x01\x01\x20" + seeds_binary.ubx_log() + sentences, "novatel": b"\x02\x01\x11" + seeds_containers.seeds()["novatel"][1:],
            "vectornav": b"\x03\0\x1f" + seeds_containers.seeds()["vectornav"][1:],
            "csv": b"\x04\0\x07" + b"time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n1000.01,0,0,0,0,0,-9.8\n1000.02,0,0,0,0,0,-9.8\n",
            "json": b"\x05\0\x30" + text(lines), "gpsd": b"\x06\x01\x50" + text([{"class": "VERSION", "proto_major": 3}, tpv, sky, tpv])}


def forms():
    scenario = {"duration_s": 60, "trajectory.type": "car", "trajectory.start": {"lat_deg": 48, "lon_deg": 11, "height_m": 500}, "imu.grade": "mems", "gnss.rate_hz": 1}
    return {"scenario_json": b"\0" + json.dumps(scenario).encode(), "dataset_json": b"\x01" + json.dumps({"imu.file": "imu.csv", "gnss.lever_arm_m": [1, 0, -1]}).encode(),
            "scenario_toml": b"\x02duration_s = 60\n[trajectory]\ntype = \"car\"\nstart = { lat_deg = 48, lon_deg = 11, height_m = 500 }\n",
            "dataset_toml": b"\x03[imu]\nfile = \"imu.csv\"\n[[outage]]\nstart_s = 1\nduration_s = 2\n", "study": b"\x04" + json.dumps({"sample_rate": 100, "file": "imu.csv"}).encode(),
            "project": b"\x06imupath: \"imu.txt\"\ngnsspath: ../gnss.txt\n", "title": "\x08Fahrt Nr. 5: Нова".encode()}


def seeds():
    return {"files": files(), "live": live(), "forms": forms()}
