#!/usr/bin/env python3
"""Latency and processor time of `schuler live` over loopback: 400 Hz of an IMU, 10 Hz of fixes, messages at a rate.

    bench/live_latency.py build/bin/schuler [--format json|csv] [--seconds 60] [--rate 0]      rate: Hz of messages, 0: every sample

The latency is from before the send of an IMU sample to the receipt of its message by this program. With others on the machine:
`chrt -r 10 bench/live_latency.py ...`
"""
import argparse
import json
import random
import socket
import subprocess
import tempfile
import threading
import time
from pathlib import Path

CONFIG = """[vehicle]
kind = "car"
[imu]
source = "tcp-listen://127.0.0.1:{imu}"
format = "{format}"
rate_hz = 400
grade = "mems"
[gnss]
source = "tcp-listen://127.0.0.1:{gnss}"
format = "{format}"
rate_hz = 10
[initial]
lat_deg = 48
lon_deg = 11
height_m = 500
roll_deg = 0
pitch_deg = 0
heading_deg = 30
[[output]]
to = "tcp-listen://127.0.0.1:{out}"
rate_hz = {rate}
"""
ZERO, STEP = 1_000_000_000_000, 2_500_000   # ns


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def connected(port):
    for _ in range(100):
        try:
            s = socket.create_connection(("127.0.0.1", port))
            s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return s
        except OSError:
            time.sleep(0.05)
    raise SystemExit("it does not listen")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--format", choices=["json", "csv"], default="json")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=0.0)
    a = parser.parse_args()
    imu, out = free_port(), free_port()
    gnss = imu if a.format == "json" else free_port()
    with tempfile.TemporaryDirectory() as folder:
        config = Path(folder) / "live.toml"
        config.write_text(CONFIG.format(imu=imu, gnss=gnss, out=out, format=a.format, rate=a.rate))
        process = subprocess.Popen([a.program, "live", str(config)], stderr=subprocess.DEVNULL)
        to_imu = connected(imu)
        to_gnss = to_imu if gnss == imu else connected(gnss)
        reader = connected(out)
        if a.format == "csv":
            to_imu.sendall(b"time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n")
            to_gnss.sendall(b"time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,std_n_m,std_e_m,std_d_m\n")
        count = int(400 * a.seconds)
        sent, latencies = [0.0] * (count + 1), []

        def read():
            rest = b""
            while data := reader.recv(65536):
                now = time.perf_counter()
                *lines, rest = (rest + data).split(b"\n")
                for line in lines:
                    if b'"state"' in line:
                        at = line.find(b'"time_ns":') + 10
                        latencies.append(now - sent[round((int(line[at:line.find(b",", at)]) - ZERO) / STEP)])

        threading.Thread(target=read, daemon=True).start()

        def used():
            fields = Path(f"/proc/{process.pid}/stat").read_text().split()
            status = Path(f"/proc/{process.pid}/status").read_text().splitlines()
            return (int(fields[13]) + int(fields[14])) / 100.0, int(next(x for x in status if "VmRSS" in x).split()[1]), time.perf_counter()

        g, begin, first = random.gauss, time.perf_counter(), None
        for k in range(1, count + 1):
            wait = begin + 0.0025 * k - time.perf_counter()
            if wait > 0:
                time.sleep(wait)
            t = (ZERO + k * STEP) * 1e-9
            if k % 40 == 0:
                fix = [48 + g(0, 1e-5), 11 + g(0, 1e-5), 500, g(0, 0.1), g(0, 0.1), 0, 1, 1, 2]
                to_gnss.sendall(((f"{t:.4f}," + ",".join(f"{x:.9f}" for x in fix)) if a.format == "csv" else json.dumps(
                    {"type": "gnss", "time_ns": ZERO + k * STEP, "lat_deg": fix[0], "lon_deg": fix[1], "height_m": 500, "velocity_m_s": fix[3:6],
                     "std_m": fix[6:]})).encode() + b"\n")
            gyro, accel = [g(0, 1e-3) for _ in range(3)], [g(0, 0.02), g(0, 0.02), g(-9.81, 0.02)]
            line = (f"{t:.4f}," + ",".join(f"{x:.7f}" for x in gyro + accel)) if a.format == "csv" else json.dumps(
                {"type": "imu", "time_ns": ZERO + k * STEP, "gyro_rad_s": gyro, "accel_m_s2": accel})
            sent[k] = time.perf_counter()
            to_imu.sendall(line.encode() + b"\n")
            if k == count // 5:
                first = used()
        last = used()
        time.sleep(0.3)
        process.terminate()
        process.wait()
    latencies.sort()
    ms = [1e3 * latencies[min(len(latencies) - 1, int(p * len(latencies)))] for p in (0.5, 0.99, 0.999, 1.0)]
    print(f"{a.format}, {len(latencies)} messages: latency median {ms[0]:.3f} ms, 99 % {ms[1]:.3f}, 99.9 % {ms[2]:.3f}, largest {ms[3]:.3f}; "
          f"{100 * (last[0] - first[0]) / (last[2] - first[2]):.2f} % of a core; memory {first[1]} kB, later {last[1]} kB")


if __name__ == "__main__":
    main()
