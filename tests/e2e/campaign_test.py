"""Campaigns from outside: killed and gone on with, shared among processes, batches of data sets, covariance beside Monte Carlo."""
import json
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from program_test import check, main

FLIGHT = """name = "flight"
seed = 7
duration_s = 60
reference_rate_hz = 1
[trajectory]
type = "paper_a"
start = { lat_deg = 55, lon_deg = 30, height_m = 5000 }
lat_amplitude_rad = 0.004
lon_rate_rad_s = 4e-5
[imu]
rate_hz = 20
grade = "tactical"
[gnss]
receiver = "autonomous"
[baro]
rate_hz = 1
bias_m = 3
[[outage]]
start_s = 40
duration_s = 15
[run]
settle_s = 10
[filter]
initial_error = { level_deg = 0.05, heading_deg = 0.5, velocity_m_s = 0.1, position_m = 5 }
"""
VARY = """[montecarlo]
vary = { "imu.gyro_bias_deg_h" = { sweep = [1, 10] }, "baro.white_m" = { uniform = [0.5, 1] } }
"""


def same_results(folder, a, b):
    for name in ("runs.csv", "epochs.csv", "sweep.csv"):
        check((folder / a / name).read_bytes() == (folder / b / name).read_bytes(), f"{name} of {a} and {b}: not the same bytes")
    summaries = [json.loads((folder / x / "summary.json").read_text()) for x in (a, b)]
    for s in summaries:
        del s["timing"], s["montecarlo"]["runs_per_s"]
    check(summaries[0] == summaries[1], f"summary.json of {a} and {b}")


def killed_when_some_are_done(command, folder, checkpoint):
    """Starts it in a session of its own, and kills all of it once a checkpoint has statistics; whether it was alive then."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    end = time.monotonic() + 100
    while process.poll() is None and time.monotonic() < end:
        if checkpoint.exists() and checkpoint.stat().st_size > 100_000:
            break
        time.sleep(0.02)
    alive = process.poll() is None
    if alive:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return alive


def with_little_room(command, folder, most):
    """Runs it where no file can be larger than `most` bytes: what a full disk does, without one."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # the write fails instead
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=200, preexec_fn=limit)


def resume(program, source):
    folder = Path(program.folder)
    (folder / "flight.toml").write_text(FLIGHT + VARY)
    runs = 400
    program("montecarlo", "flight.toml", "-n", runs, "-o", "whole", "--jobs", 2, "--quiet")
    command = [program.path, "montecarlo", "flight.toml", "-n", str(runs), "-o", "cut", "--jobs", "1", "--quiet"]
    check(killed_when_some_are_done(command, folder, folder / "cut/checkpoint-0.bin"), "the campaign was to be killed before its end")
    check(not (folder / "cut/summary.json").exists(), "no summary of half a campaign")
    program.fails("montecarlo", "flight.toml", "-n", runs, "-o", "cut", parts=["interrupted", "--resume"])
    program.fails("montecarlo", "flight.toml", "-n", runs, "-o", "cut", "--resume", "--seed", 9, parts=["another scenario"])
    program("montecarlo", "flight.toml", "-n", runs, "-o", "cut", "--resume", "--jobs", 2, "--quiet")
    same_results(folder, "whole", "cut")
    check(not list((folder / "cut").glob("*.bin")), "no checkpoint is left")
    # one run again, alone
    program("montecarlo", "flight.toml", "--first", 17, "-n", 1, "-o", "one", "--quiet")
    check((folder / "one/runs.csv").read_text().splitlines()[1] == (folder / "whole/runs.csv").read_text().splitlines()[18], "run 17 alone is run 17")
    # a disk that is full: a stop that can be gone on with
    full = [program.path, "montecarlo", "flight.toml", "-n", str(runs), "-o", "full", "--quiet"]
    done = with_little_room(full, folder, 60_000)
    check(done.returncode == 2, f"a full disk: exit status {done.returncode}")
    check("cannot be written" in done.stderr and "--resume goes on" in done.stderr, done.stderr)
    check(not (folder / "full/summary.json").exists(), "no summary of half a campaign")
    program("montecarlo", "flight.toml", "-n", runs, "-o", "full", "--resume", "--quiet")
    same_results(folder, "whole", "full")
    # and one where only the files of the results find no room
    program("simulate", "flight.toml", "-o", "log", "--quiet")
    done = with_little_room([program.path, "process", "log", "-o", "narrow", "--quiet"], folder, 60_000)
    check(done.returncode == 2 and "cannot be written" in done.stderr, f"exit status {done.returncode}: {done.stderr}")
    check(not list((folder / "narrow").glob("*.csv")), "half a solution is left")
    for n in (0, -1, "1e30", "x"):
        program.fails("montecarlo", "flight.toml", "-n", n, "-o", "none", parts=["--runs"])
    (folder / "file").write_text("")
    program.fails("montecarlo", "flight.toml", "-n", 3, "-o", "file/inside", parts=["file"])


def nothing_to_show(program, source):
    """A campaign whose runs end before the filter has settled says so; one with a scheme of which every run fails is not to be used."""
    folder = Path(program.folder)
    (folder / "brief.toml").write_text(FLIGHT.replace("settle_s = 10", "settle_s = 100"))
    done = program("montecarlo", "brief.toml", "-n", "2", "-o", "brief")
    check("no statistics of errors" in done.stderr and "100 s" in done.stderr, done.stderr)
    (folder / "flight.toml").write_text(FLIGHT)
    check("no statistics of errors" not in program("montecarlo", "flight.toml", "-n", "2", "-o", "flight").stderr, "told without cause")
    (folder / "schemes.toml").write_text(FLIGHT + '[compare]\nschemes = ["loose", "separate"]\n')
    done = program("montecarlo", "schemes.toml", "-n", "2", "--smooth", "--backward", "-o", "schemes")
    check("no smoother for separate" in done.stderr and "filter.backward is given and has no effect" in done.stderr, done.stderr)
    told = json.loads((folder / "schemes/summary.json").read_text())
    check(any("no smoother for separate" in text for text in told["warnings"]) and told["montecarlo"]["failed"] == 0, "and in summary.json")
    (folder / "schemes.toml").write_text(FLIGHT + '[compare]\nschemes = ["loose", "tight"]\n')  # there are no ranges
    failed = subprocess.run([program.path, "montecarlo", "schemes.toml", "-n", "2", "-o", "failed"], cwd=folder, capture_output=True, text=True)
    check(failed.returncode == 1 and failed.stdout.splitlines()[-1] == "do not use: every run of scheme tight failed", failed.stdout)
    check((folder / "failed/summary.json").is_file(), "not written")


def batch(program, source):
    folder = Path(program.folder)
    (folder / "flight.toml").write_text(FLIGHT)
    for k in (1, 2):
        program("simulate", "flight.toml", "-o", f"sets/d{k}", "--seed", k)
    (folder / "sets/broken").mkdir()
    (folder / "sets/broken/imu.csv").write_text("hello\n1\n")
    (folder / "list.txt").write_text("# logs\nsets/d1\n\nsets/broken\nsets/d2\nsets/../sets/d1\n")
    out = subprocess.run([program.path, "batch", "list.txt", "-o", "out", "--jobs", "2"], cwd=folder, capture_output=True, text=True)
    check(out.returncode == 1, f"one has failed: exit status {out.returncode}: {out.stderr}")
    rows = (folder / "out/batch.csv").read_text().splitlines()
    check(len(rows) == 4 and rows[1].startswith("broken,failed"), f"three data sets, the worst first: {rows}")
    check("d1" in out.stdout and "d2" in out.stdout and "broken" in out.stderr, "the table has all, the warnings the reason")
    table = json.loads((folder / "out/batch.json").read_text())
    check(table["datasets"] == 3 and table["failed"] == 1, f"counts: {table}")
    good = [row for row in table["rows"] if row["verdict"] != "failed"]
    check(good[0]["horizontal_rms_m"] >= good[1]["horizontal_rms_m"], "the larger error first, where the verdict is the same")
    alone = json.loads(program("process", "sets/d1", "-o", "alone", "--json").stdout)["errors"]["position_m"]["horizontal"]["rms"]
    check(any(row["name"] == "d1" and row["horizontal_rms_m"] == alone for row in good), "as `process` does it")
    index = (folder / "out/index.html").read_text()
    check('href="d1/report.html"' in index and (folder / "out/d1/report.html").exists(), "the index links the reports")
    before = (folder / "out/d1/summary.json").stat().st_mtime_ns
    again = subprocess.run([program.path, "batch", "list.txt", "-o", "out", "--resume", "--quiet"], cwd=folder, capture_output=True, text=True)
    check(again.returncode == 1 and (folder / "out/batch.csv").read_text().splitlines() == rows, "the same table again")
    check((folder / "out/d1/summary.json").stat().st_mtime_ns == before, "what is done is not done again")
    program("batch", "sets/d1", "sets/d2", "-o", "two", "--quiet")
    program.fails("batch", "nowhere.txt", parts=["nowhere.txt", "does not exist"])
    (folder / "empty.txt").write_text("# nothing\n")
    program.fails("batch", "empty.txt", parts=["no data set"])


def covariance(program, source):
    """The linear covariance is what 50 seeds show, within their scatter; a filter that believes in better gyros is found out by both."""
    folder = Path(program.folder)
    flight = FLIGHT.replace("duration_s = 60", "duration_s = 150").replace("start_s = 40\nduration_s = 15", "start_s = 100\nduration_s = 40")
    flight = flight.replace('grade = "tactical"', 'grade = "tactical"\ngyro_noise_deg_sqrt_h = 1.0')
    wrong = flight.replace("[filter]\n", '[filter]\nassumed = { gyro_noise_deg_sqrt_h = 0.4 }\n')
    for name, text, honest in (("right", flight, True), ("wrong", wrong, False)):
        (folder / f"{name}.toml").write_text(text)
        table = json.loads(program("analyze", "covariance", f"{name}.toml", "--json").stdout)
        rows = {row["source"]: row for row in table["rows"]}
        summary = json.loads(program("montecarlo", f"{name}.toml", "-n", 50, "-o", name, "--json").stdout)
        position, velocity = summary["errors"]["position_m"], summary["errors"]["velocity_m_s"]
        flown = {"horizontal_m": position["horizontal"]["rms"], "up_m": position["up"]["rms"],
                 "velocity_m_s": math.hypot(*(velocity[k]["rms"] for k in ("east", "north", "up"))),
                 "heading_deg": summary["errors"]["attitude_deg"]["heading"]["rms"],
                 "outage_end_horizontal_m": summary["outages"][0]["end_horizontal_m"]}
        for key, value in flown.items():
            # 50 runs, each worth at least one independent value: one sigma is a tenth; four of them
            check(0.65 < value / rows["all"][key] < 1.45, f"{name}, {key}: {value} flown, {rows['all'][key]} predicted")
        end = "outage_end_horizontal_m"
        ratio = rows["all"][end] / rows["filter"][end]
        check(0.97 < ratio < 1.03 if honest else ratio > 1.2, f"{name}: true {rows['all'][end]}, stated {rows['filter'][end]}")
        square = sum((row[end] or 0.0) ** 2 for key, row in rows.items() if key not in ("all", "filter"))
        check(abs(math.sqrt(square) / rows["all"][end] - 1) < 1e-6, "the sources add up")
    found = json.loads(program("analyze", "covariance", "right.toml", "--outage", 30, "--find", "imu.gyro_bias_deg_h", "--target", 8, "--json").stdout)["found"]
    (folder / "found.toml").write_text(flight.replace('grade = "tactical"', f'grade = "tactical"\ngyro_bias_deg_h = {found["value"]}'))
    back = json.loads(program("analyze", "covariance", "found.toml", "--outage", 30, "--json").stdout)
    check(abs(back["outages"][0]["true_horizontal_m"] - 8) < 0.02, f"what is found gives the target: {back['outages']}")
    program.fails("analyze", "covariance", "right.toml", "--find", "imu.gyro_bias", "--target", 4, parts=["imu.gyro_bias_deg_h"])
    program.fails("analyze", "covariance", "right.toml", "--find", "imu.gyro_bias_deg_h", parts=["--target"])
    program.fails("analyze", "covariance", "right.toml", "--outage", 3000, parts=["--outage"])
    (folder / "bare.toml").write_text(flight[:flight.index("initial_error")])
    program.fails("analyze", "covariance", "bare.toml", parts=["initial_error"])

    # the end of the same path tells what the covariance of the filter says, and a turn what rest and straight flight do not
    seen = json.loads(program("analyze", "observability", "right.toml", "--json").stdout)
    states = {state["state"]: state for state in seen["states"]}
    check(seen["refused"] == 0 and states["attitude_down"]["end"] < states["attitude_down"]["start"], f"observability: {list(states)}")
    for state in seen["states"] + seen["combinations"]:
        check(state["left"] > 0.999 or abs(sum(state["shares"].values()) - 1) < 1e-6, f"shares add up: {state}")
    # of tight coupling, with corrections by measurements alone: the sources are what the filter states (ranges cause a sixth of the variance)
    alone = [word for key in ("mag.use", "filter.nonholonomic", "filter.zero_velocity") for word in ("--set", f"{key}=false")]
    table = json.loads(program("analyze", "covariance", Path(source) / "examples/car-tight.toml", *alone, "--json").stdout)
    rows = {row["source"]: row for row in table["rows"]}
    for key in ("horizontal_m", "up_m", "velocity_m_s", "heading_deg"):
        check(0.94 < rows["all"][key] / rows["filter"][key] < 1.03, f"tight, {key}: {rows['all'][key]} of {rows['filter'][key]}")
        check(rows["ranges"][key] > 0.3 * rows["all"][key], f"tight, {key}: {rows['ranges'][key]} by ranges")
    tight = json.loads(program("analyze", "observability", Path(source) / "examples/car-tight.toml", "--json").stdout)
    told = program("analyze", "observability", "right.toml", "--set", "filter.integrity.use=true").stderr
    check("filter.integrity.use has no effect" in told, f"what is set aside is named: {told}")
    check("clock_bias" in {state["state"] for state in tight["states"]}, "a tight filter has its receiver's clock")
    program.fails("analyze", "observability", "right.toml", "--vn", 1, parts=["--vn", "scenario"])
    program.fails("analyze", "observability", "--rate", 10, parts=["--rate", "scenario"])
    program.fails("analyze", "observability", "right.toml", "--set", "filter.scheme=gnss", parts=["filter.scheme", "no filter"])


def mpi(program, source):
    folder = Path(program.folder)
    (folder / "flight.toml").write_text(FLIGHT + VARY)
    if shutil.which("mpirun") is None:
        print("skipped: there is no mpirun (Debian: openmpi-bin)")
        sys.exit(77)

    def start(ranks, *arguments):
        return ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), program.path, *map(str, arguments)]

    probe = subprocess.run(start(2, "montecarlo", "flight.toml", "-n", 4, "-o", "probe", "--quiet"), cwd=folder, capture_output=True, text=True)
    if "built without MPI" in probe.stderr:
        check(probe.returncode == 2 and not (folder / "probe").exists(), "a program without MPI refuses to be several processes")
        print("skipped: the program is built without -DSCHULER_MPI=ON")
        sys.exit(77)
    check(probe.returncode == 0, f"two ranks: {probe.stderr}")
    program("montecarlo", "flight.toml", "-n", 60, "-o", "alone", "--quiet")
    for ranks in (1, 2, 4):
        done = subprocess.run(start(ranks, "montecarlo", "flight.toml", "-n", 60, "-o", f"ranks{ranks}", "--quiet"), cwd=folder, capture_output=True, text=True)
        check(done.returncode == 0, f"{ranks} ranks: {done.stderr}")
        same_results(folder, "alone", f"ranks{ranks}")
        check(not list((folder / f"ranks{ranks}").glob("*.bin")), "no checkpoint is left")
    bad = subprocess.run(start(2, "montecarlo", "nowhere.toml", "-n", 2), cwd=folder, capture_output=True, text=True)
    check(bad.returncode == 2 and bad.stderr.count("schuler: ") == 1, f"one complaint: {bad.returncode} {bad.stderr}")
    # a rank is killed: the others end with it, and what each has done is kept
    program("montecarlo", "flight.toml", "-n", 400, "-o", "whole", "--quiet")
    job = subprocess.Popen(start(2, "montecarlo", "flight.toml", "-n", 400, "-o", "cut", "--quiet"), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    parts = [folder / f"cut/checkpoint-{k}.bin" for k in (0, 1)]
    while job.poll() is None and not all(p.exists() and p.stat().st_size > 100_000 for p in parts):
        time.sleep(0.02)
    children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(job.pid)], capture_output=True, text=True).stdout.split()
    check(job.poll() is None and len(children) == 2, "the job was to be killed before its end")
    os.kill(int(children[1]), signal.SIGKILL)
    check(job.wait(timeout=60) != 0, "a lost rank ends the job")
    done = subprocess.run(start(2, "montecarlo", "flight.toml", "-n", 400, "-o", "cut", "--resume", "--quiet"), cwd=folder, capture_output=True, text=True)
    check(done.returncode == 0, f"resumed: {done.stderr}")
    same_results(folder, "whole", "cut")


if __name__ == "__main__":
    main({"campaign_resume": resume, "campaign_batch": batch, "campaign_covariance": covariance, "campaign_mpi": mpi, "campaign_nothing": nothing_to_show})
