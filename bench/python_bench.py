"""Speed of the Python package: samples a second into the navigator, and what a whole run costs more than the program.

    PYTHONPATH=build/python python3 bench/python_bench.py --program build/bin/schuler
"""
import argparse
import resource
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import schuler


def feed_rate(recording, block):
    """Million samples a second of processor time: median of five."""
    imu, gnss = recording.imu, recording.gnss
    settings = recording.stream_settings()
    edges = np.arange(0, len(imu), block)
    fixes = np.searchsorted(gnss.time_ns, [imu.time_ns[min(e + block, len(imu)) - 1] for e in edges], side="right")
    rates = []
    for _ in range(5):
        navigator = schuler.Navigator(settings, lag=max(0.5, 0.02 * block))
        begin, done = time.process_time(), 0
        for edge, fix in zip(edges, fixes):
            if fix > done:
                part = slice(done, fix)
                navigator.feed_gnss(gnss.time_ns[part], gnss.position[part], gnss.velocity[part], gnss.std_position[part], gnss.std_velocity[part])
                done = fix
            part = slice(edge, edge + block)
            if block == 1:
                navigator.feed_imu(imu.time_ns[edge], imu.gyro[edge], imu.accel[edge])
            else:
                navigator.feed_imu(imu.time_ns[part], imu.gyro[part], imu.accel[part])
        rates.append(len(imu) / (time.process_time() - begin) / 1e6)
        if navigator.phase != schuler.Phase.NAVIGATING:
            raise SystemExit("it does not navigate")
    return statistics.median(rates)


def whole_run(program, folder, out):
    """Seconds of processor time of the program and of the package for the same files, medians of seven pairs in turn."""
    def seconds(who):
        used = resource.getrusage(who)
        return used.ru_utime + used.ru_stime

    theirs, mine = [], []
    for k in range(7):
        begin = seconds(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "process", folder, "-o", out / f"a{k}", "--outputs", "summary,h5", "-q"], check=True, capture_output=True)
        theirs.append(seconds(resource.RUSAGE_CHILDREN) - begin)
        begin = seconds(resource.RUSAGE_SELF)
        schuler.process(folder, output=out / f"b{k}", outputs=["summary", "h5"]).solution.position.mean()
        mine.append(seconds(resource.RUSAGE_SELF) - begin)
    return statistics.median(theirs), statistics.median(mine)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    program = parser.parse_args().program
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        scenario = Path(__file__).resolve().parent.parent / "examples/demo.toml"
        subprocess.run([program, "simulate", scenario, "-o", root / "drive"], check=True, capture_output=True)
        recording = schuler.open(root / "drive")
        print(f"{len(recording.imu)} IMU samples, {len(recording.gnss)} fixes")
        for block in (1, 10, 100, 400):
            print(f"blocks of {block:5d}: {feed_rate(recording, block):.2f} million samples/s")
        theirs, mine = whole_run(program, root / "drive", root)
        print(f"whole run: program {theirs:.3f} s, package {mine:.3f} s ({100 * (mine / theirs - 1):+.1f} %)")


if __name__ == "__main__":
    main()
