"""Writes the fixes of a simulated drive as a u-blox log (UBX, NAV-PVT), for the cookbook: docs/cookbook.md.

    python3 examples/cookbook/ubx_of_fixes.py out/drive/gnss.csv rover.ubx [2025-07-08]

Times of the table are seconds after noon, UTC, of the date; the layout is that of the u-blox M8 interface description, 92 bytes.
"""
import csv
import datetime
import math
import struct
import sys


def message(kind, number, payload):
    body = struct.pack("<BBH", kind, number, len(payload)) + payload
    a = b = 0
    for byte in body:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return b"\xb5\x62" + body + bytes([a, b])


def nav_pvt(row, noon):
    seconds = float(row["time_s"])
    moment = noon + datetime.timedelta(seconds=int(seconds))
    nano = round(1e9 * (seconds - int(seconds)))
    of_week = (moment.isoweekday() % 7) * 86400 + moment.hour * 3600 + moment.minute * 60 + moment.second + 18   # leap seconds

    def number(name, scale):
        return round(float(row[name]) * scale)

    def size(*names):   # a receiver states one length for the horizontal and one for the velocity
        return round(1e3 * math.hypot(*(float(row[name]) for name in names)))

    fixed = row["fix"] == "rtk_fixed"
    north, east = float(row["vel_n_m_s"]), float(row["vel_e_m_s"])
    height = number("height_m", 1e3)
    return struct.pack(
        "<IHBBBBBBIiBBBBiiiiIIiiiiiIIH6BihH", of_week % 604800 * 1000 + nano // 1_000_000, moment.year, moment.month, moment.day, moment.hour, moment.minute,
        moment.second, 7, 20, nano, 3, 1 | (0x82 if fixed else 0), 0, 14, number("lon_deg", 1e7), number("lat_deg", 1e7), height, height,
        size("std_n_m", "std_e_m"), size("std_d_m"), round(1e3 * north), round(1e3 * east), number("vel_d_m_s", 1e3),
        round(1e3 * math.hypot(north, east)), 0, size("std_vn_m_s", "std_ve_m_s", "std_vd_m_s"), 100000, 120, 0, 0, 0, 0, 0, 0, 0, 0, 0)


def main():
    table, out = sys.argv[1:3]
    noon = datetime.datetime.fromisoformat((sys.argv[3] if len(sys.argv) > 3 else "2025-07-08") + "T12:00:00")
    with open(table, newline="") as rows, open(out, "wb") as file:
        for row in csv.DictReader(rows):
            file.write(message(0x01, 0x07, nav_pvt(row, noon)))


main()
