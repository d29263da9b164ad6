"""What the server of `schuler ui` can be asked to do beside single runs, from outside.

    ui_commands_test.py TOPIC --program PATH --source ROOT      exit status 0 passed, 1 failed
"""
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


if __name__ == "__main__":
    sys.exit(main({"commands": commands}))
