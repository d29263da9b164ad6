"""What nobody should lose: files of the user's own, a terminal, the time of somebody who names the wrong file."""
import gzip
import json
import os
import resource
import shutil
import signal
import subprocess
import time
from pathlib import Path

from program_test import check, main

SCENARIO = """name = "brief"
duration_s = 20
[trajectory]
type = "static"
start = { lat_deg = 50, lon_deg = 30, height_m = 100 }
[imu]
rate_hz = 50
grade = "mems"
[gnss]
rate_hz = 1
"""


def ran(program, *arguments):
    return subprocess.run([program.path, *map(str, arguments)], cwd=program.folder, capture_output=True, text=True, timeout=100, stdin=subprocess.DEVNULL)


def files(folder):
    """Names and contents of a folder, hidden ones left out."""
    return {p.name: p.read_bytes() for p in Path(folder).iterdir() if p.is_file() and not p.name.startswith(".")}


def overwriting(program, _):
    folder = Path(program.folder)
    (folder / "brief.toml").write_text(SCENARIO)
    # a folder with logs of the user's own
    own = folder / "own"
    own.mkdir()
    (own / "imu.csv").write_text("time_s,mine\n")
    program.fails("simulate", "brief.toml", "-o", own, parts=["imu.csv", "exists", "-o"])
    check(files(own) == {"imu.csv": b"time_s,mine\n"}, "a folder with logs stays as it is")
    # what the program itself has written it writes again
    drive = folder / "drive"
    program("simulate", "brief.toml", "-o", drive)
    first = files(drive)
    program("simulate", "brief.toml", "-o", drive)
    check(files(drive) == first, "simulated again into the same folder")
    program("process", drive, "-o", "out", "--quiet")
    program("process", drive, "-o", "out", "--quiet")
    # a result beside the logs is no reference for the next run
    bare = folder / "bare"
    bare.mkdir()
    for name in ("imu.csv", "gnss.csv"):
        shutil.copyfile(drive / name, bare / name)
    for _ in range(2):
        program("process", bare, "-o", bare, "--quiet")
        check(json.loads((bare / "summary.json").read_text())["reference"] is None, "nothing to compare with")
    # unless somebody has changed it
    with open(drive / "imu.csv", "a") as f:
        f.write("# a note\n")
    changed = files(drive)
    program.fails("simulate", "brief.toml", "-o", drive, parts=["imu.csv"])
    check(files(drive) == changed, "a changed log is the user's")
    program("simulate", "brief.toml", "-o", drive, "--force")
    check(files(drive) == first, "unless the user insists")
    program.fails("run", "brief.toml", "--force", parts=["-o"])
    with open(drive / "imu.csv", "a") as f:
        f.write("# a note\n")
    # inputs as targets
    program.fails("convert", drive / "reference.csv", drive / "reference.csv", parts=["reference.csv", "another name"])
    check(files(drive) == changed, "an input is not written")
    mine = folder / "mine.kml"
    mine.write_text("mine")
    program.fails("convert", drive / "reference.csv", mine, parts=["mine.kml"])
    check(mine.read_text() == "mine", "another's file is not written")


def together(program, _):
    """Files of a run appear together, or none."""
    folder = Path(program.folder)
    (folder / "brief.toml").write_text(SCENARIO)
    program("run", "brief.toml", "-o", "result", "--quiet")
    before = files(folder / "result")
    check("solution.csv" in before and "summary.json" in before, "a run writes its files")

    def cut():   # as a full disk: writing beyond fails
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))

    for target in ("result", "fresh"):
        done = subprocess.run([program.path, "run", "brief.toml", "--seed", "5", "--output-rate", "0", "-o", target, "--quiet"], cwd=folder,
                              capture_output=True, text=True, timeout=60, preexec_fn=cut)
        check(done.returncode == 2, f"a full disk is a failure: {done.returncode} {done.stderr}")
        check(len(done.stderr.strip().split("\n")) == 1 and "disk" in done.stderr, f"in one line: {done.stderr}")
    check(files(folder / "result") == before, "the older run's files are whole")
    check(not list((folder / "result").glob(".*part*")), "nothing is left behind")
    check(not (folder / "fresh").exists() or not files(folder / "fresh"), "no file of the failed run")


def special_files(program, _):
    """Pipes, devices, windows into the system: nobody waits for them."""
    folder = Path(program.folder)
    os.mkfifo(folder / "pipe.csv")
    (folder / "brief.toml").write_text(SCENARIO)
    begin = time.time()
    for name in ("pipe.csv", "/dev/zero", "/proc/self/mem", "/proc/kmsg"):
        for command in (["inspect", name], ["process", name], ["convert", name, "x.csv"], ["evaluate", name, name], ["run", name],
                        ["process", "brief.toml", "--config", name], ["receiver", "track", name, "--sample-rate", "4e6"]):
            program.fails(*command, parts=[])
    check(time.time() - begin < 60, "at once")


def bombs(program, _):
    """Files that unpack to gigabytes, are a hole of gigabytes, or a million columns wide."""
    folder = Path(program.folder)
    block = gzip.compress(bytes(1 << 24))
    with open(folder / "zeros.csv.gz", "wb") as f:
        for _ in range(128):   # 2 GB
            f.write(block)
    with open(folder / "hole.ubx", "wb") as f:
        f.truncate(10 << 30)
    (folder / "wide.csv").write_text(",".join(f"c{i}" for i in range(1_000_000)) + "\n")

    def limited():
        resource.setrlimit(resource.RLIMIT_AS, (3 << 29, 3 << 29))

    sanitized = "asan" in program.path
    for name in ("zeros.csv.gz", "hole.ubx", "wide.csv"):
        begin = time.time()
        done = subprocess.run([program.path, "inspect", name], cwd=folder, capture_output=True, text=True, timeout=120,
                              preexec_fn=None if sanitized else limited)
        check(done.returncode in (0, 2), f"{name}: {done.returncode} {done.stdout[:300]} {done.stderr[:300]}")
        check("memory" not in done.stderr, f"{name}: {done.stderr}")
        check(time.time() - begin < 30, f"{name} takes {time.time() - begin:.0f} s")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()


def terminal(program, _):
    """Control characters of names and cells do not reach the terminal."""
    folder = Path(program.folder)
    evil = "\x1b]0;title\x07\x1b[31m"
    (folder / f"{evil}.csv").write_text("time_s,lat_deg\n1,2\n")
    (folder / "cells.csv").write_text(f"time_s,{evil}\n1,{evil}\n")
    (folder / "keys.toml").write_text('"\\u001b[31m\\u0007" = 1\n')
    for command in (["inspect", f"{evil}.csv"], ["process", f"{evil}.csv"], ["inspect", "cells.csv"], ["evaluate", "cells.csv", "cells.csv"],
                    ["run", "keys.toml"], ["process", ".", "--set", f"{evil}=1"], [evil]):
        done = ran(program, *command)
        check("\x1b" not in done.stdout + done.stderr and "\x07" not in done.stdout + done.stderr, f"{command}: {done.stdout!r} {done.stderr!r}")


def extremes(program, _):
    """Values inside their ranges, and beyond."""
    folder = Path(program.folder)
    (folder / "brief.toml").write_text(SCENARIO)
    program("simulate", "brief.toml", "-o", "drive")
    for options in (["--output-rate", "1e-308"], ["--set", "imu.time_offset_s=3.9e9"], ["--start", "-1e300"], ["--settle", "1e300"]):
        done = ran(program, "process", "drive", "-o", "extreme", *options)
        check(done.returncode in (0, 1, 2), f"{options}: {done.returncode} {done.stderr}")
    # What takes long is said before it begins.
    (folder / "large.toml").write_text(SCENARIO.replace("duration_s = 20", "duration_s = 40000").replace("rate_hz = 50", "rate_hz = 1000"))
    with subprocess.Popen([program.path, "simulate", "large.toml", "-o", "large"], cwd=folder, stderr=subprocess.PIPE, text=True) as large:
        said = large.stderr.readline()
        large.kill()
    check("4e+07 samples of the IMU" in said and "minutes" in said and "GB" in said, f"a large simulation begins with '{said}'")
    check(not ran(program, "simulate", "brief.toml", "-o", "small").stderr, "a small simulation speaks of its size")
    (folder / "deep.toml").write_text("a." * 10_000 + "a = 1\n")
    for command in (["run", "deep.toml"], ["process", "drive", "--config", "deep.toml"], ["simulate", "deep.toml", "-o", "x"]):
        program.fails(*command, parts=["deep.toml", "1:"])


if __name__ == "__main__":
    main({"overwriting": overwriting, "together": together, "special_files": special_files, "bombs": bombs, "terminal": terminal, "extremes": extremes})
