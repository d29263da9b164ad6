"""What the server of `schuler ui` can be asked to do beside single runs, from outside.

    ui_commands_test.py TOPIC --program PATH --source ROOT      exit status 0 passed, 1 failed
"""
import http.client
import json
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from program_test import check
from ui_server_test import SMALL, Server, main, refused


def commands(program, source):
    """A campaign and a survey of gravity are runs as well; noise of the IMU is asked of a child; what cannot be done is refused."""
    with tempfile.TemporaryDirectory() as folder, Server(program, folder) as server:
        order = {"kind": "scenario", "toml": SMALL, "title": "many"}
        refused(server, "POST", "/api/runs", 422, ("montecarlo",), {**order, "command": "rm"})
        refused(server, "POST", "/api/runs", 422, ("2 to 100000",), {**order, "command": "montecarlo", "runs": 1})
        refused(server, "POST", "/api/runs", 400, (), {**order, "command": "montecarlo", "runs": "many"})
        refused(server, "POST", "/api/runs", 422, ("command",), {"kind": "dataset", "dataset": "x", "command": "montecarlo"})
        many = server.json("POST", "/api/runs", {**order, "command": "montecarlo", "runs": 3}, 201)["id"]
        end = server.finished(many)
        check(end["state"] == "done" and end["kind"] == "montecarlo", f"the campaign ends: {end['message']}")
        check(end["summary"]["montecarlo"]["runs"] == 3, "so many runs as ordered")
        groups = {g["group"]: g for g in server.json("GET", f"/api/runs/{many}/channels")}
        check(set(groups) == {"/ensemble"}, f"its table is a group: {set(groups)}")
        units = {c["name"]: c["unit"] for c in groups["/ensemble"]["columns"]}
        check(units["position_east_m_q95"] == "m" and units["velocity_up_m_s_rms"] == "m/s", f"units of its columns: {units}")
        column = "/ensemble/table:position_east_m_rms"
        series = server.json("GET", f"/api/runs/{many}/series?columns={column}&points=0")
        rows = [line.split(",") for line in (Path(folder) / "work" / many / "epochs.csv").read_text().splitlines()]
        told = [float(r[rows[0].index("position_east_m_rms")]) for r in rows[1:]]
        check(series["columns"][column] == told, "the numbers are those of epochs.csv")
        # cancelled at work: nothing of it is left to be taken for a result
        endless = {**order, "command": "montecarlo", "runs": 5000, "title": "long"}
        long = server.json("POST", "/api/runs", endless, 201)["id"]
        time.sleep(1.0)
        server.json("POST", f"/api/runs/{long}/cancel")
        end = server.finished(long)
        check(end["state"] == "cancelled" and "epochs.csv" not in end["files"], f"a campaign is cancelled: {end['state']}")

        one = server.json("POST", "/api/runs", {**order, "title": "one"}, 201)["id"]
        server.finished(one)
        noise = server.json("GET", f"/api/runs/{one}/noise")
        axes = [a["sensor"] + a["axis"] for a in noise["axes"]]
        check(axes == [s + a for s in ("gyro", "accel") for a in "xyz"], f"six axes: {axes}")
        for axis in noise["axes"]:
            tau, spectrum = axis["allan"]["tau_s"], axis["spectrum"]
            check(len(tau) > 10 and tau == sorted(tau), f"averaging times ascend: {tau[:3]}")
            check(abs(tau[0] * noise["rate_hz"] - 1.0) < 1e-9, "from one sample on")
            check(len(spectrum["frequency_hz"]) == len(spectrum["density"]) > 10, "a spectrum")
        refused(server, "GET", "/api/runs/none/noise", 404)
        refused(server, "GET", f"/api/runs/{many}/noise/x", 404)
        refused(server, "GET", "/api/datasets/none/noise", 404)

        every_row(server, Path(folder))
        microseconds(server)
        forms(server)
        attitude(server, Path(folder))
        batches(server)
        kept(server, program, folder, order)
    live(program)


def every_row(server, folder):
    """Every row is every row, to the end; of too many the extremes, from the beginning to the end."""
    for name, rows in (("whole-rows", 30_000), ("too-many-rows", 510_000)):
        run = folder / "work" / name
        run.mkdir()
        (run / "run.json").write_text(json.dumps({"title": name, "created": 1, "kind": "dataset", "state": "done"}))
        (run / "summary.json").write_text("{}")
        with open(run / "solution.csv", "w") as file:
            file.write("time_s,roll_deg\n")
            file.writelines(f"{i / 100},{i % 700 / 10}\n" for i in range(rows))
        path = f"/api/runs/{name}/series?columns=/attitude/table:roll_deg&points=0"
        series = server.json("GET", path)
        whole = rows < 500_000
        check(series["thinned"] != whole and series["rows"] == rows, f"{name}: thinned {series['thinned']}, {series['rows']} rows")
        check((len(series["time_s"]) == rows) == whole, f"{name}: {len(series['time_s'])} rows are given")
        check(series["time_s"][-1] == (rows - 1) / 100, f"{name}: to the end: {series['time_s'][-1]}")


def microseconds(server):
    """Times of a log that has them in another unit are drawn in seconds; a column with gaps keeps its extremes."""
    name = server.json("POST", "/api/datasets", {"title": "fast"})["name"]
    head = "time_us,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2,note_m"
    rows = [f"{5_000_000 + 10_000 * i},0.1,0,0,0,0,-9.81,{'' if i % 7 else 3 + (i == 777)}" for i in range(4000)]
    server.json("PUT", f"/api/datasets/{name}/files/imu.csv", ("\n".join([head, *rows]) + "\n").encode(), 201)
    raw = server.json("GET", f"/api/datasets/{name}/raw?file=imu.csv&points=100")
    check(abs(raw["time_s"][-1] - 39.99) < 1e-9 and abs(raw["zero"] - 5.0) < 1e-9, f"in seconds: {raw['time_s'][-1]}, {raw['zero']}")
    check(raw["thinned"] and 4 in raw["columns"]["note_m"], "the extreme of a column with gaps is kept")


def forms(server):
    """Options of the commands are forms; what they do not take is refused, what they take reaches the run."""
    forms = {f["command"]: {o["key"] for o in f["options"]} for f in server.json("GET", "/api/commands")}
    check({"smooth", "backward", "outage", "scheme"} <= forms["process"], f"options of process: {forms.get('process')}")
    check(not forms["process"] & {"output", "config", "set", "json", "progress"}, "what the server says itself is not asked")
    order = {"kind": "scenario", "toml": SMALL}
    refused(server, "POST", "/api/runs", 422, ("unknown key",), {**order, "arguments": {"config": "/etc/passwd"}})
    refused(server, "POST", "/api/runs", 422, (), {**order, "arguments": {"scheme": "none such"}})
    run = server.json("POST", "/api/runs", {**order, "title": "smoothed", "arguments": {"smooth": True}}, 201)["id"]
    end = server.finished(run)
    check(end["summary"]["smoothed"] is True, f"the option reaches the run: {end['message']}")
    check(end["order"] == {"command": "run", "runs": 0, "arguments": {"smooth": True}}, f"and is kept to run again: {end['order']}")
    quality = [c["id"] for g in server.json("GET", f"/api/runs/{run}/channels") if g["group"] == "/gnss" for c in g["columns"]]
    check("/gnss/quality:fix" in quality, f"fixes have their quality: {quality}")


def attitude(server, folder):
    """A log without GNSS: attitude alone, its solution.csv as a group; a field of gravity comes with its example."""
    name = server.json("POST", "/api/datasets", {"title": "hand"})["name"]
    rows = ["time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"]
    rows += [f"{i / 100},0.001,0.002,0.003,0.01,0.02,-9.81" for i in range(2000)]
    server.json("PUT", f"/api/datasets/{name}/files/day/imu.csv", "\n".join(rows) + "\n", 201)
    [files] = [d["files"] for d in server.json("GET", "/api/datasets") if d["name"] == name]
    check([f["name"] for f in files] == ["day/imu.csv"], f"an upload keeps its folder: {files}")
    run = server.json("POST", "/api/runs", {"kind": "dataset", "dataset": name, "command": "ahrs", "arguments": {"offline": True}}, 201)["id"]
    end = server.finished(run)
    check(end["state"] == "done" and end["summary"]["command"] == "ahrs", f"attitude without GNSS: {end['message']}")
    groups = {g["group"]: [c["name"] for c in g["columns"]] for g in server.json("GET", f"/api/runs/{run}/channels")}
    check("roll_deg" in groups["/attitude"], f"its solution is a group: {groups}")
    examples = {e["name"]: e for e in server.json("GET", "/api/examples")}
    check("gravity-field" not in examples, "files of examples are no examples")
    survey = server.json("POST", "/api/settings", {"toml": examples["gravity-survey"]["toml"]})
    check(survey["problem"] is None, f"a survey over a field of the ground: {survey['problem']}")


def batches(server):
    """Several data sets with the same settings: a run of each, the one that cannot start too; names are not used twice."""
    sets = [server.json("POST", "/api/datasets", {"title": name})["name"] for name in ("first", "second")]
    before = len(server.json("GET", "/api/runs"))
    refused(server, "POST", "/api/batches", 422, ("datasets",), {"title": "x", "datasets": []})
    refused(server, "POST", "/api/batches", 404, ("none",), {"title": "x", "datasets": [sets[0], "none"]})
    refused(server, "POST", "/api/batches", 400, (), {"title": "x", "datasets": ["../data"]})
    check(len(server.json("GET", "/api/runs")) == before, "nothing of a refused batch is started")
    order = {"title": "both", "datasets": sets, "settings": {"filter.scheme": "loose"}, "arguments": {"smooth": True}}
    for name in ("both", "both 2"):
        batch = server.json("POST", "/api/batches", order, 201)
        check(batch["batch"] == name and len(batch["runs"]) == 2, f"its name and runs: {batch}")
        for run in batch["runs"]:
            end = server.finished(run)
            check(end["batch"] == name and end["state"] == "failed" and end["message"], f"an empty data set fails with its reason: {end}")
    wrong = server.json("POST", "/api/batches", {**order, "settings": {"filter.scheme": "none such"}}, 201)
    states = [server.json("GET", f"/api/runs/{run}") for run in wrong["runs"]]
    check(all(s["state"] == "failed" and "none such" in s["message"] for s in states), f"settings that cannot be: {states}")
    run = batch["runs"][0]
    check(server.json("PATCH", f"/api/runs/{run}", {"note": "wet"})["note"] == "wet", "a note is kept")
    check(server.json("PATCH", f"/api/runs/{run}", {"title": "new"})["note"] == "wet", "beside a new title")
    refused(server, "PATCH", f"/api/runs/{run}", 422, ("note",), {"note": "x" * 5000})
    refused(server, "POST", "/api/runs", 422, ("batch",), {"kind": "scenario", "toml": SMALL, "batch": 5})


def live(program):
    """Messages of `schuler live` as events; what is no message is passed over, a lost connection is told."""
    with socket.create_server(("127.0.0.1", 0)) as source, tempfile.TemporaryDirectory() as folder:
        address = f"tcp://127.0.0.1:{source.getsockname()[1]}"
        wrong = subprocess.run([program, "ui", "--live", "serial:/dev/ttyS0"], cwd=folder, capture_output=True, text=True, timeout=60)
        check(wrong.returncode == 2 and "tcp://HOST:PORT" in wrong.stderr, f"an address that is none: {wrong.returncode} {wrong.stderr}")
        with Server(program, folder) as server:
            check(server.json("GET", "/api/about")["live"] is None, "nothing live by itself")
            refused(server, "GET", "/api/live", 404, ("--live",))
        with Server(program, folder, "--live", address) as server:
            check(server.json("GET", "/api/about")["live"] == address, "the address is told")
            refused(server, "GET", "/api/live", 401, (), headers={"Authorization": None})
            link = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
            link.request("GET", "/api/live", headers={"Authorization": f"Bearer {server.token}"})
            source.settimeout(20)
            sender, _ = source.accept()
            sender.sendall(b'{"type":"state","lat_deg":1}\nrubbish\n[1]\n"' + b"x" * 200_000 + b'"\n{"type":"hea')
            time.sleep(0.3)
            sender.sendall(b'lth"}\n')
            sender.close()
            reply, events = link.getresponse(), []
            while len(events) < 4:
                line = reply.readline().decode()
                if line.startswith("event: "):
                    events.append((line[7:].strip(), json.loads(reply.readline().decode()[6:])))
            link.close()
            check([e[0] for e in events] == ["link", "live", "live", "link"], f"connection, two messages, its end: {events}")
            check(events[1][1] == {"type": "state", "lat_deg": 1} and events[2][1] == {"type": "health"}, f"whole messages: {events}")
            check(events[0][1]["connected"] and not events[3][1]["connected"] and events[3][1]["text"], f"and why: {events[3]}")


def kept(server, program, folder, order):
    """Layouts are kept in the workspace; a second server on it leaves the runs of the first alone."""
    check(server.json("GET", "/api/layouts") is None, "no layouts at first")
    server.json("PUT", "/api/layouts", {"mine": [[{"id": "/solution/position:height"}]]})
    check("mine" in server.json("GET", "/api/layouts"), "layouts are kept")
    refused(server, "PUT", "/api/layouts", 422, (), [1])
    run = server.json("POST", "/api/runs", {**order, "command": "montecarlo", "runs": 5000, "title": "at work"}, 201)["id"]
    with Server(program, folder) as second:
        state = second.json("GET", f"/api/runs/{run}")["state"]
        check(state in ("waiting", "running"), f"a second server does not end the runs of the first: {state}")
    server.json("POST", f"/api/runs/{run}/cancel")
    server.finished(run)


if __name__ == "__main__":
    sys.exit(main({"commands": commands}))
