"""`schuler live`: replays through real connections, pulled cables, garbage, clocks that jump, readers that do not read, state kept over a restart."""
import atexit
import csv
import functools
import json
import math
import os
import re
import signal
import socket
import struct
import subprocess
import time
from pathlib import Path

from program_test import check, main


def port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def drive(program, source, name="drive", seconds=240, more=""):
    """A simulated drive; returns its dataset.toml."""
    text = (source / "examples/demo.toml").read_text()
    scenario = Path(program.folder) / "short.toml"
    scenario.write_text(re.sub(r"(?m)^duration_s = .*$", f"duration_s = {seconds}", text) + more)
    program("simulate", str(scenario), "-o", name)
    return Path(program.folder) / name / "dataset.toml"


def configured(program, described, place, outputs, name="live.toml", more="", columns=("imu", "gnss", "baro")):
    """The data set's own settings with sources instead of files."""
    text = re.sub(r"(?ms)^\[output\]\n.*?(?=^\[|\Z)", "", described.read_text()).replace("smooth = true", "smooth = false")
    for section in columns:
        text = text.replace(f"[{section}]\n", f'[{section}]\nsource = "{place}"\nformat = "json"\n', 1)
    file = Path(program.folder) / name
    file.write_text(text + f"\n[live]\nlag_s = 0.5\nstill_delay_s = 0.65\nhealth_every_s = 0.2\n{more}\n{outputs}")
    return file


def started(program, file):
    process = subprocess.Popen([program.path, "live", str(file)], cwd=program.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL)
    atexit.register(lambda: process.poll() is None and process.kill())   # a test that fails leaves nothing behind
    return process


def ended(process, how=signal.SIGTERM):
    process.send_signal(how)
    out, err = process.communicate(timeout=60)
    check(process.returncode == 0, f"exit status {process.returncode}: {err[-400:]}")
    return out.decode(), err.decode()


def connected(number, seconds=10.0):
    until = time.monotonic() + seconds
    while True:
        try:
            return socket.create_connection(("127.0.0.1", number), timeout=10)
        except OSError:
            if time.monotonic() > until:
                raise   # a failed check goes on: nobody would end the loop
            time.sleep(0.05)


def messages(path, kind):
    found = []
    text = path.read_text()
    for line in text[:text.rfind("\n") + 1].splitlines():   # a file that is written meanwhile may end within a line
        message = json.loads(line)
        if message["type"] == kind:
            found.append(message)
    return found


def until(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            check(False, "it does not happen")
            return
        time.sleep(0.05)


def live_replay(program, source):
    """A replay through loopback: the rows are those of the batch once both have found themselves."""
    described = drive(program, source)
    number = port()
    file = configured(program, described, f"tcp-listen://127.0.0.1:{number}",
                      '[[output]]\nto = "file:lag.csv"\nformat = "csv"\nat = "lag"\nrate_hz = 10\n[[output]]\nto = "file:now.jsonl"\nrate_hz = 10\n')
    process = started(program, file)
    sent = program("replay", "drive", "--to", f"tcp://127.0.0.1:{number}", "--speed", "0")
    check("samples sent" in sent.stdout, sent.stdout)
    folder = Path(program.folder)
    until(lambda: any((message["time_s"] or 0.0) >= 240.0 for message in messages(folder / "now.jsonl", "health")))
    _, err = ended(process)
    check("navigating" in err and "stopped after" in err, err)
    program("process", "drive", "--set", "filter.smooth=false", "--self-check", "off", "-o", "batch", "--output-rate", "10")
    with open(folder / "batch/solution.csv") as a, open(folder / "lag.csv") as b:
        batch = {round(float(r["time_s"]), 1): r for r in csv.DictReader(a)}
        live = list(csv.DictReader(b))
    last = [r for r in live if float(r["time_s"]) > 200.0]
    check(len(last) > 300 and float(last[-1]["time_s"]) > 238.0, f"{len(last)} rows")
    worst = 0.0
    for r in last:
        other = batch[round(float(r["time_s"]), 1)]
        north = math.radians(float(r["lat_deg"]) - float(other["lat_deg"])) * 6.37e6
        east = math.radians(float(r["lon_deg"]) - float(other["lon_deg"])) * 6.37e6 * math.cos(math.radians(float(r["lat_deg"])))
        worst = max(worst, math.hypot(north, east) / float(other["std_n_m"]))
    print(f"live against batch: at most {worst:.2f} sigma apart")
    check(worst < 0.5, f"{worst} sigma")
    now = messages(folder / "now.jsonl", "state")
    check(now[-1]["time_s"] == 240.0 and now[-1]["at"] == "now", f"{now[-1]}")
    check(messages(folder / "now.jsonl", "health")[-1]["dropped"] == 0, "dropped")


def live_gauges(program, source):
    """Height gauges and a velocity log from one stream of lines carry the solution through 50 s without fixes; without them its
    sigmas are larger. Both are right about the truth."""
    described = drive(program, source, seconds=150, more="\n[gauges]\nrate_hz = 2\nwhite_m = 0.02\nlever_arms_m = [[0, 0, 1], [2, 0, 1]]\n"
                      "[log]\nrate_hz = 5\nwhite_m_s = 0.01\n")
    folder = Path(program.folder)
    lines = program("replay", "drive", "--to", "stdout", "--speed", "0").stdout.splitlines(keepends=True)
    check(sum('"gauges"' in line for line in lines) > 250 and sum('"log"' in line for line in lines) > 600, "not replayed")
    late = lambda line: json.loads(line)["time_ns"] > 100 * 10**9
    (folder / "all.jsonl").write_text("".join(line for line in lines if not ('"gnss"' in line and late(line))))
    with open(folder / "drive/reference.csv") as f:
        truth = {round(float(r["time_s"]), 1): r for r in csv.DictReader(f)}
    sigma = {}
    for name, columns in (("all", ("imu", "gnss", "baro", "gauges", "log")), ("few", ("imu", "gnss", "baro"))):
        file = configured(program, described, "file:all.jsonl", f'[[output]]\nto = "file:{name}.csv"\nformat = "csv"\nat = "lag"\nrate_hz = 10\n',
                          name=f"{name}.toml", columns=columns)
        if name == "all":
            file.write_text(file.read_text().replace("[gauges]\n", "[gauges]\ncount = 2\n"))
        said = program("live", str(file)).stderr
        check(("there is no source of gauges" in said) == (name == "few"), said)
        with open(folder / f"{name}.csv") as f:
            last = next(r for r in csv.DictReader(f) if float(r["time_s"]) >= 145.0)
        true = truth[round(float(last["time_s"]), 1)]
        for axis in "ned":
            sigma[name, axis] = float(last[f"std_v{axis}_m_s"])
            error = float(last[f"vel_{axis}_m_s"]) - float(true[f"vel_{axis}_m_s"])
            check(abs(error) < 4.0 * sigma[name, axis], f"{name} {axis}: {error} at {sigma[name, axis]}")
        sigma[name, "height"] = float(last["std_d_m"])
    print({f"{name} {axis}": round(value, 4) for (name, axis), value in sigma.items()})
    check(sigma["all", "height"] < 0.5 * sigma["few", "height"], "the gauges are not used")
    check(sigma["all", "n"] < 0.5 * sigma["few", "n"] and sigma["all", "e"] < 0.5 * sigma["few", "e"], "the log is not used")


def live_trouble(program, source):
    """Garbage, a pulled cable, a clock that jumps, a reader that does not read: it goes on and says so."""
    described = drive(program, source, seconds=120)
    number, served = port(), port()
    file = configured(program, described, f"tcp-listen://127.0.0.1:{number}", '[[output]]\nto = "file:now.jsonl"\nrate_hz = 1\n'
                      f'[[output]]\nto = "tcp-listen://127.0.0.1:{served}"\nrate_hz = 0\nqueue_kb = 64\n', more='state = "live.state"')
    lines = program("replay", "drive", "--to", "stdout", "--speed", "0").stdout.splitlines(keepends=True)
    # the replay's own times, seconds from the start
    stamp = lambda line: int(re.search(r'"time_ns":(-?\d+)', line).group(1)) * 1e-9
    process = started(program, file)
    connected(served).close()   # it listens
    idle = socket.socket()      # never reads
    idle.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    idle.connect(("127.0.0.1", served))
    now = Path(program.folder) / "now.jsonl"

    def feed(chosen, cut=b""):
        with connected(number) as s:
            s.sendall("".join(chosen).encode() + cut)
        time.sleep(0.3)

    feed([l for l in lines if stamp(l) < 80.0], cut=b'{"type":"imu","time_ns":8000')   # the cable is pulled within a line
    feed(["\x00\xff garbage\n", "{\"type\":\n", "a" * 100000, "\n"] + [l for l in lines if 80.0 <= stamp(l) < 90.0])
    until(lambda: messages(now, "state") and messages(now, "state")[-1]["time_s"] > 88.5)
    # a message of health tells of what was before it
    until(lambda: any(m["garbage"] >= 3 and m["reconnections"] == 1 and m["dropped"] > 100 for m in messages(now, "health")), 20.0)
    health = messages(now, "health")[-1]
    check(health["phase"] == "navigating" and health["garbage"] >= 3 and health["reconnections"] == 1, f"{health}")
    check(health["restarts"] == 0, "a second connection is no restart")
    check(health["dropped"] > 100, f"a reader that does not read: {health['dropped']} dropped")
    # the clock of the IMU goes on an hour later: alignment begins anew
    moved = [re.sub(r'"time_ns":(\d+)', lambda m: f'"time_ns":{int(m.group(1)) + 3600 * 10**9}', l) for l in lines if 90.0 <= stamp(l) < 100.0]
    feed(moved)
    until(lambda: any(message["restarts"] >= 1 for message in messages(now, "health")))
    check(any(e["kind"] == "restarted" for e in messages(now, "event")), "nothing said")
    idle.close()
    _, err = ended(process, signal.SIGINT)
    for part in ("unparseable", "connection was closed", "does not keep up", "alignment restarts"):
        check(part in err, f"{part}: {err}")


def live_state(program, source):
    """What was navigating goes on navigating after a restart of the program; a state of other settings is refused in a line."""
    described = drive(program, source, seconds=120)
    output = '[[output]]\nto = "file:now.jsonl"\nrate_hz = 10\n'
    file = configured(program, described, "file:first.jsonl", output, more='state = "live.state"')
    lines = program("replay", "drive", "--to", "stdout", "--speed", "0").stdout.splitlines(keepends=True)
    half = next(i for i, line in enumerate(lines) if '"imu"' in line and int(re.search(r'"time_ns":(-?\d+)', line).group(1)) >= 90 * 10**9)
    folder = Path(program.folder)
    (folder / "first.jsonl").write_text("".join(lines[:half]))
    program("live", str(file))
    before = len(messages(folder / "now.jsonl", "event"))
    (folder / "first.jsonl").write_text("".join(lines[half:]))
    done = program("live", str(file))
    check("restored" in done.stderr, done.stderr)
    later = messages(folder / "now.jsonl", "event")[before:]
    check(not any(e["kind"] == "phase" for e in later), f"aligned anew: {later}")
    (folder / "one.jsonl").write_text("".join(lines))
    (folder / "now.jsonl").rename(folder / "two.jsonl")
    whole = configured(program, described, "file:one.jsonl", output, name="one.toml")
    program("live", str(whole))
    check(messages(folder / "two.jsonl", "state")[-1] == messages(folder / "now.jsonl", "state")[-1], "other bits than without a restart")
    other = configured(program, described, "file:first.jsonl", output, name="other.toml", more='state = "live.state"')
    other.write_text(other.read_text().replace("lag_s = 0.5", "lag_s = 0.4"))
    check("of other settings" in program("live", str(other)).stderr, "not refused")
    for wrong, part in (('source = "tcp://nowhere"', "port"), ('source = "telepathy"', "bad.toml:2: imu.source: \"telepathy\" is not a known kind of endpoint"), ('source = "stdin"\nformt = "json"', "format")):
        bad = folder / "bad.toml"
        bad.write_text(f'[imu]\n{wrong}\n[[output]]\nto = "stdout"\n')
        check(part in program("live", str(bad), status=2).stderr, wrong)
    # Outputs are appended to: to nothing that another program made, and to no source.
    imu = (folder / "drive/imu.csv").read_bytes()
    for name, part in (("drive/imu.csv", "does not begin"), ("first.jsonl", "is a source")):
        bad = configured(program, described, "file:first.jsonl", f'[[output]]\nto = "file:{name}"\nformat = "json"\n', name="bad.toml")
        check(part in program("live", str(bad), status=2).stderr, name)
    check((folder / "drive/imu.csv").read_bytes() == imu, "a log was written to")


def live_satellites(program, source):
    """What a receiver says about its satellites is in the messages, also before anything navigates."""
    described = drive(program, source, seconds=120)
    number, receiver = port(), port()
    file = configured(program, described, f"tcp-listen://127.0.0.1:{number}", '[[output]]\nto = "file:now.jsonl"\nrate_hz = 1\n')
    text = re.sub(r'(?m)(^\[gnss\]\n)source = .*\nformat = .*$', rf'\1source = "tcp-listen://127.0.0.1:{receiver}"\nformat = "nmea"', file.read_text())
    check('format = "nmea"' in text, text)
    file.write_text(text)
    process = started(program, file)
    sentence = lambda body: f"${body}*{functools.reduce(lambda a, b: a ^ b, body.encode()):02X}\r\n"
    now = Path(program.folder) / "now.jsonl"
    with connected(receiver) as s:
        s.sendall((sentence("GNRMC,120000.00,A,4800.0000,N,01100.0000,E,1.00,90.00,010524,,,A") + sentence("GNGSA,A,3,05,,,,,,,,,,,,1.2,0.9,0.8,1")
                   + sentence("GPGSV,1,1,02,05,30,120,44,12,,,20,1")).encode())
        until(lambda: now.exists() and messages(now, "satellites"), 20.0)
    ended(process)
    told = (messages(now, "satellites") or [{"satellites": None}])[-1]
    check(told["satellites"] == [{"name": "G05", "elevation_deg": 30, "azimuth_deg": 120, "cn0_db_hz": 44, "used": True},
                                 {"name": "G12", "elevation_deg": None, "azimuth_deg": None, "cn0_db_hz": 20, "used": False}], f"{told}")


def records(data):
    """The kinds and bodies of an MCAP file without chunks."""
    magic = b"\x89MCAP0\r\n"
    check(data.startswith(magic) and data.endswith(magic), "no magic bytes at both ends")
    at, out = len(magic), []
    while at < len(data) - len(magic):
        kind, size = struct.unpack_from("<BQ", data, at)
        out.append((kind, data[at + 9:at + 9 + size]))
        at += 9 + size
    check(at == len(data) - len(magic), "the last record is cut")
    return out


def live_outputs(program, source):
    """MCAP files are whole, one a run, and hold what the table holds; shared memory holds the newest state, and goes with its writer."""
    described = drive(program, source, seconds=120)
    name, number, folder = f"schuler-test-{os.getpid()}", port(), Path(program.folder)
    outputs = f'[[output]]\nto = "file:now.csv"\nformat = "csv"\n[[output]]\nto = "file:live.mcap"\nformat = "mcap"\n[[output]]\nto = "shm:{name}"\n'
    file = configured(program, described, f"tcp-listen://127.0.0.1:{number}", outputs + '[[output]]\nto = "file:now.jsonl"\n')
    process = started(program, file)
    program("replay", "drive", "--to", f"tcp://127.0.0.1:{number}", "--speed", "0")
    until(lambda: any((message["time_s"] or 0.0) >= 120.0 for message in messages(folder / "now.jsonl", "health")))
    shared = Path("/dev/shm") / name
    data = shared.read_bytes()
    magic, size, running, sequence, count, heartbeat, time_ns = struct.unpack_from("<8sIIQQqq", data)
    check((magic, size, running) == (b"SCHULER1", len(data), 1) and sequence == 2 * count and count > 5000, f"{magic} {size} {running} {sequence} {count}")
    check(time_ns == 120 * 10**9 and 0 < time.clock_gettime_ns(time.CLOCK_MONOTONIC) - heartbeat < 60 * 10**9, f"{time_ns} {heartbeat}")
    state = messages(folder / "now.jsonl", "state")[-1]
    values = struct.unpack_from("<18d", data, 48)
    keys = ("lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg",
            "std_n_m", "std_e_m", "std_d_m", "std_vn_m_s", "std_ve_m_s", "std_vd_m_s", "std_roll_deg", "std_pitch_deg", "std_heading_deg")
    check(all(abs(v - state[k]) < 1e-3 for v, k in zip(values, keys)), f"{values} {state}")
    second = configured(program, described, f"tcp-listen://127.0.0.1:{port()}", f'[[output]]\nto = "shm:{name}"\n', name="second.toml")
    other = started(program, second)
    check(any(b"another run writes it" in line for line in iter(other.stderr.readline, b"")), "a second writer")
    ended(other)
    check(shared.exists(), "taken away by the second writer")
    ended(process)
    check(not shared.exists(), "left behind")
    found = records((folder / "live.mcap").read_bytes())
    rows = list(csv.DictReader(open(folder / "now.csv")))
    channels = {struct.unpack_from("<H", body)[0]: body[8:8 + struct.unpack_from("<I", body, 4)[0]].decode() for kind, body in found if kind == 4}
    check(channels == {1: "/fix", 2: "/attitude", 3: "/velocity", 4: "/event", 5: "/health", 6: "/satellites"}, f"{channels}")
    said = {topic: [body for kind, body in found if kind == 5 and struct.unpack_from("<H", body)[0] == k] for k, topic in channels.items()}
    check(len(said["/fix"]) == len(said["/attitude"]) == len(said["/velocity"]) == len(rows) > 500, f"{len(rows)} rows")
    for body, row in zip(said["/fix"], rows):   # after the header with the frame "wgs84", status and service
        lat, lon, height = struct.unpack_from("<3d", body, 22 + 4 + 8 + 12 + 4)
        check(abs(lat - float(row["lat_deg"])) < 1e-9 and abs(lon - float(row["lon_deg"])) < 1e-9 and abs(height - float(row["height_m"])) < 1e-3, f"{lat} {row}")
    check(any(json.loads(body[22:])["kind"] == "phase" for body in said["/event"]) and json.loads(said["/health"][-1][22:])["dropped"] == 0, "events")
    check("live.mcap" in program("inspect", "live.mcap").stdout, "not read")
    lines = program("replay", "drive", "--to", "stdout", "--speed", "0").stdout
    (folder / "all.jsonl").write_text(lines)
    again = configured(program, described, "file:all.jsonl", outputs.replace(f'[[output]]\nto = "shm:{name}"\n', ""), name="again.toml")
    program("live", str(again))
    check(records((folder / "live.mcap.1").read_bytes()) == found and len(records((folder / "live.mcap").read_bytes())) > 500, "the file of the first run")
    for wrong, part in (('to = "shm:a/b"', "has no name of letters"), ('to = "shm:a"\nformat = "json"', "its own layout"), ('to = "udp://127.0.0.1:5"\nformat = "mcap"', "has a beginning"),
                        ('to = "file:live.mcap"\nformat = "mcap"\nkeep = 0', "no older file is kept"), ('to = "file:drive/imu.csv"\nformat = "mcap"', "does not begin")):
        bad = configured(program, described, "file:all.jsonl", f"[[output]]\n{wrong}\n", name="bad.toml")
        check(part in program("live", str(bad), status=2).stderr, wrong)


def live_service(program, source):
    """Under a service manager: standard error is a socket, and the log arrives; the manager hears when the inputs stand, that the loop turns
    (and not when it hangs), and the end."""
    described = drive(program, source, seconds=60)
    late, number, folder = port(), port(), Path(program.folder)
    file = configured(program, described, f"tcp-listen://127.0.0.1:{number}", '[[output]]\nto = "file:now.jsonl"\n')
    file.write_text(re.sub(r'(?m)(^\[baro\]\n)source = .*$', rf'\1source = "tcp://127.0.0.1:{late}"', file.read_text()))
    manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    manager.bind(str(folder / "notify"))
    manager.settimeout(0.05)
    heard = []

    def hear(seconds, wanted=None):
        """What the manager hears until then, or until `wanted`; all of it is in `heard`."""
        fresh, end = [], time.monotonic() + seconds
        while time.monotonic() < end and not (wanted and any(wanted in text for text in fresh)):
            try:
                fresh.append(manager.recv(4096).decode())
            except TimeoutError:
                pass
        heard.extend(fresh)
        return fresh

    journal, stderr = socket.socketpair()
    process = subprocess.Popen([program.path, "live", str(file)], cwd=folder, stdout=subprocess.DEVNULL, stderr=stderr, stdin=subprocess.DEVNULL,
                               env={**os.environ, "NOTIFY_SOCKET": str(folder / "notify"), "WATCHDOG_USEC": "400000"})
    atexit.register(lambda: process.poll() is None and process.kill())
    stderr.close()
    fresh = hear(1.5)
    check("READY=1" not in fresh, f"ready although a source is not there: {fresh}")
    check(4 <= fresh.count("WATCHDOG=1") <= 12 and any(text.startswith("STATUS=waiting_for_imu") for text in fresh), f"{fresh}")
    with socket.create_server(("127.0.0.1", late)):
        check("READY=1" in hear(40.0, "READY=1"), f"not ready: {heard}")
        program("replay", "drive", "--to", f"tcp://127.0.0.1:{number}", "--speed", "0")
        check(any("navigating" in text for text in hear(40.0, "STATUS=navigating")), f"{heard}")
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.3)
        hear(0.2)
        check("WATCHDOG=1" not in hear(1.0), "it says that it turns, and does not")
        process.send_signal(signal.SIGCONT)
        check("WATCHDOG=1" in hear(5.0, "WATCHDOG=1"), "it turns again")
        process.send_signal(signal.SIGTERM)
        check(process.wait(60) == 0, f"exit status {process.returncode}")
    hear(0.3)
    check(heard.count("READY=1") == 1 and heard[-1] == "STOPPING=1", f"{heard[-3:]}")
    journal.settimeout(5)
    log = b"".join(iter(lambda: journal.recv(65536), b"")).decode()
    check("connected" in log and "navigating" in log and "stopped after" in log, f"the log on a socket: {log!r}")
    bad = configured(program, described, "stdin", '[[output]]\nto = "stdout"\n', name="bad.toml", more='log = "missing/live.log"')
    check(all(part in program("live", str(bad), status=2).stderr for part in ("bad.toml", "live.log", "cannot be opened")), "a log that cannot be opened")


if __name__ == "__main__":
    main({"live_service": live_service, "live_replay": live_replay, "live_gauges": live_gauges, "live_trouble": live_trouble, "live_state": live_state, "live_satellites": live_satellites, "live_outputs": live_outputs})
