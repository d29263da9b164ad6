"""What nobody should lose: files of the user's own, a terminal, the time of somebody who names the wrong file."""
import gzip
import json
import os
import random as numbers
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

    # a full disk after any number of bytes, while text or HDF5 is written
    for outputs, limits in ((None, (5_000, 60_000)), ("h5", (1, 3_000, 20_000, 60_000, 200_000))):
        for limit in limits:
            def cut():   # writing beyond fails
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

            for target in ("result", "fresh"):
                done = subprocess.run([program.path, "run", "brief.toml", "--seed", "5", "--output-rate", "0", "-o", target, "--quiet",
                                       *(["--outputs", outputs] if outputs else [])], cwd=folder, capture_output=True, text=True, timeout=60, preexec_fn=cut)
                what = f"{outputs} at {limit} bytes"
                check(done.returncode == 2, f"a full disk is a failure: {what}: {done.returncode} {done.stderr}")
                check(len(done.stderr.strip().split("\n")) == 1 and "disk" in done.stderr, f"in one line: {what}: {done.stderr}")
            check(files(folder / "result") == before, f"the older run's files are whole: {what}")
            check(not list((folder / "result").glob(".*part*")), f"nothing is left behind: {what}")
            check(not (folder / "fresh").exists() or not files(folder / "fresh"), f"no file of the failed run: {what}")
    # what the older run had and the new one has not goes with it, and nothing else
    program("run", "brief.toml", "-o", "result", "--quiet", "--outputs", "solution,states,report,summary,kml")
    check({"states.csv", "report.html", "track.kml"} <= set(files(folder / "result")), f"{files(folder / 'result').keys()}")
    (folder / "result/notes.txt").write_text("mine")
    program("run", "brief.toml", "-o", "result", "--quiet", "--outputs", "solution,summary", "--seed", "5")
    check(set(files(folder / "result")) == {"solution.csv", "summary.json", "notes.txt"}, f"files of one run and the user's: {files(folder / 'result').keys()}")
    program("simulate", "brief.toml", "-o", "mixed")
    program("process", "mixed", "-o", "mixed", "--quiet", "--outputs", "solution,summary,report")
    program("process", "mixed", "-o", "mixed", "--quiet", "--outputs", "summary")
    check(set(files(folder / "mixed")) == {"dataset.toml", "gnss.csv", "imu.csv", "reference.csv", "summary.json"}, f"logs beside a result stay: {files(folder / 'mixed').keys()}")


def killed(program, _):
    """Killed while its files are moved: where summary.json is, all files are of its run, and none of another."""
    folder = Path(program.folder)
    (folder / "brief.toml").write_text(SCENARIO)
    kinds = {1: "solution,summary,states,config", 2: "solution,summary,report,kml", 3: "solution,summary,h5"}
    expected = {}
    command = lambda seed, target: [program.path, "run", "brief.toml", "--seed", str(seed), "--outputs", kinds[seed], "-o", target, "--quiet"]
    for seed in kinds:
        subprocess.run(command(seed, f"run{seed}"), cwd=folder, check=True, timeout=60, stdin=subprocess.DEVNULL)
        expected[seed] = files(folder / f"run{seed}")
    random, target = numbers.Random(7), folder / "result"
    found = {True: 0, False: 0}
    for turn in range(60):
        seed = 1 + turn % 3
        subprocess.run(command(1 + (turn + 1) % 3, "result"), cwd=folder, check=True, timeout=60, stdin=subprocess.DEVNULL)   # a whole older result
        list_before = (target / ".schuler").stat().st_size if (target / ".schuler").exists() else 0
        run = subprocess.Popen(command(seed, "result"), cwd=folder, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        # the list of written files grows when the moving begins
        while run.poll() is None and (not (target / ".schuler").exists() or (target / ".schuler").stat().st_size == list_before):
            pass
        time.sleep(random.uniform(0.0, 0.02) ** 1.5)
        run.kill()
        error = run.communicate()[1]
        check(run.returncode in (0, -signal.SIGKILL), f"what was left is in the way: {error}")
        now = files(target)
        found["summary.json" in now] += 1
        if "summary.json" in now:
            of = json.loads(now["summary.json"])["seed"]
            check(now.keys() == expected[of].keys(), f"files of another run: {sorted(now)} instead of {sorted(expected[of])}")
            for name, content in now.items():
                if name in expected[of] and name not in ("summary.json", "report.html"):   # these hold the time that was spent
                    check(content == expected[of][name], f"{name} is not of the run of summary.json")
    print(f"{found[True]} times a whole result, {found[False]} times none")


def memory(program, _):
    """Out of memory: one line that names what was read, and how to need less."""
    folder = Path(program.folder)
    if "asan" in program.path:
        return
    (folder / "large.toml").write_text(SCENARIO.replace("duration_s = 20", "duration_s = 40000").replace("rate_hz = 50", "rate_hz = 1000"))
    logs = folder / "logs"
    logs.mkdir()
    with open(logs / "imu.csv", "w") as f:
        f.write("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n")
        f.writelines(f"{i / 1000:.3f},0,0,0,0,0,-9.8\n" for i in range(4_000_000))
    with open(logs / "gnss.csv", "w") as f:
        f.write("time_s,lat_deg,lon_deg,height_m\n")
        f.writelines(f"{i},50,30,100\n" for i in range(4_000))
    limited = lambda: resource.setrlimit(resource.RLIMIT_AS, (400_000_000, 400_000_000))
    for command, less in ((["run", "large.toml"], "shorter"), (["simulate", "large.toml", "-o", "x"], "shorter"), (["process", "logs", "-o", "y"], "--start and --stop"),
                          (["convert", "logs/imu.csv", "z.mat"], "")):
        done = subprocess.run([program.path, *command, "--quiet"], cwd=folder, capture_output=True, text=True, timeout=120, preexec_fn=limited, stdin=subprocess.DEVNULL)
        check(done.returncode in (1, 2) and done.stderr.count("\n") == 1, f"{command}: {done.returncode} {done.stderr}")
        if command[0] != "convert":
            check("out of memory" in done.stderr and command[1] in done.stderr and less in done.stderr, f"{command}: {done.stderr}")
    check(not (folder / "x/imu.csv").exists() and not (folder / "y/summary.json").exists(), "half a result")


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
        limit = 30 if sanitized else 5 if name == "wide.csv" else 30
        check(time.time() - begin < limit, f"{name} takes {time.time() - begin:.0f} s")
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
    check("4e+07 IMU samples" in said and "minutes" in said and "GB" in said, f"a large simulation begins with '{said}'")
    check(not ran(program, "simulate", "brief.toml", "-o", "small").stderr, "a small simulation speaks of its size")
    # beyond their ranges: file or option, and key
    (folder / "nose.toml").write_text(SCENARIO.replace('type = "static"', 'type = "static"\nattitude_deg = [0, -90, 0]'))
    done = ran(program, "run", "nose.toml", "-o", "nose")
    check(done.returncode == 0 or ("nose.toml" in done.stderr and "attitude_deg" in done.stderr), f"pitch -90: {done.returncode} {done.stderr}")
    text = (folder / "drive/dataset.toml").read_text()
    (folder / "drive/late.toml").write_text(text.replace("[gnss]", "[gnss]\ntime_offset_s = 1e10", 1))
    program.fails("process", "drive/late.toml", "-o", "late", parts=["late.toml", "gnss.time_offset_s", "out of range"])
    program.fails("process", "drive", "-o", "late", "--set", "imu.time_offset_s=1e10", parts=["imu.time_offset_s", "out of range"])
    (folder / "survey.toml").write_text(SCENARIO.replace('type = "static"', 'type = "great_circle"\nspeed_m_s = 10').replace("duration_s = 20", "duration_s = 300")
                                        + "[gravity]\nlength_m = 1\n")
    done = ran(program, "gravity", "survey.toml", "-o", "survey")
    check(done.returncode in (0, 1, 2) and "nan" not in (done.stdout + done.stderr).lower(), f"gravity.length_m = 1: {done.returncode} {done.stdout} {done.stderr}")
    # raw measurements as their own target, and pipes by the usual sign
    (folder / "u.ubx").write_bytes(b"\xb5\x62" * 100)
    program.fails("convert", "u.ubx", "u.ubx", "--to", "rinex-obs", parts=["u.ubx", "another name"])
    check((folder / "u.ubx").read_bytes() == b"\xb5\x62" * 100, "an input is not written")
    for command in (["inspect", "-"], ["process", "-"], ["convert", "-", "x.csv"], ["convert", "drive/reference.csv", "-"], ["evaluate", "-", "-"], ["run", "-"],
                    ["process", "drive", "--config", "-"]):
        program.fails(*command, parts=['"-"', "into a file", "schuler live"])
    check("not pipes" in program("--help").stdout, "the help says what inputs are")
    (folder / "deep.toml").write_text("a." * 10_000 + "a = 1\n")
    for command in (["run", "deep.toml"], ["process", "drive", "--config", "deep.toml"], ["simulate", "deep.toml", "-o", "x"]):
        program.fails(*command, parts=["deep.toml", "1:"])


if __name__ == "__main__":
    main({"overwriting": overwriting, "together": together, "killed": killed, "memory": memory, "special_files": special_files, "bombs": bombs, "terminal": terminal, "extremes": extremes})
