"""The server of `schuler ui` from outside: its API against its own document, runs, uploads, and requests that must be refused.

    ui_server_test.py TOPIC --program PATH --source ROOT      exit status 0 passed, 1 failed
"""
import argparse
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from program_test import DRIVE, FAILURES, check

SMALL = DRIVE[: DRIVE.index("[[outage]]")]


class Server:
    def __init__(self, program, folder, *options):
        self.folder = Path(folder)
        self.process = subprocess.Popen(
            [program, "ui", "--port", "0", "--workspace", str(self.folder / "work"), *options],
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            stdin=subprocess.DEVNULL,
            cwd=folder,
        )
        self.line = self.process.stdout.readline()
        match = re.fullmatch(r"Schuler is at http://([^:/]+):(\d+)/\?token=([0-9a-f]{32})\n", self.line)
        if not match:
            raise SystemExit(f"the server does not say where it is: {self.line!r} {self.process.stderr.read()}")
        self.host, self.port, self.token = match.group(1), int(match.group(2)), match.group(3)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        check(self.process.wait(timeout=20) == 0, "the server ends on SIGTERM")

    def ask(self, method, path, body=None, headers=None, host=None):
        link = http.client.HTTPConnection("127.0.0.1", self.port, timeout=150)
        data = json.dumps(body) if isinstance(body, (dict, list)) else body
        sent = {"Host": host or f"127.0.0.1:{self.port}", "Authorization": f"Bearer {self.token}", **(headers or {})}
        sent = {name: value for name, value in sent.items() if value is not None}
        link.request(method, path, data, sent)
        reply = link.getresponse()
        content = reply.read()
        link.close()
        return reply, content

    def json(self, method, path, body=None, status=200, headers=None):
        reply, content = self.ask(method, path, body, headers)
        check(reply.status == status, f"{method} {path}: {reply.status}, expected {status}: {content[:200]!r}")
        return json.loads(content) if content else None

    def raw(self, data, wait=5.0):
        """Sends bytes as they are and returns everything that comes back until the server closes."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=wait) as link:
            out = b""
            try:
                link.sendall(data)
                while chunk := link.recv(65536):
                    out += chunk
            except (ConnectionResetError, BrokenPipeError, TimeoutError):
                pass
            return out

    def finished(self, run, limit=120.0):
        begin = time.monotonic()
        while time.monotonic() - begin < limit:
            now = self.json("GET", f"/api/runs/{run}")
            if now["state"] not in ("waiting", "running"):
                return now
            time.sleep(0.2)
        raise SystemExit(f"{run} does not end")


def children_of(parent):
    out = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == parent:
            out.append(int(stat.parent.name))
    return out


def refused(server, method, path, status, parts=(), body=None, headers=None, host=None):
    reply, content = server.ask(method, path, body, headers, host)
    check(reply.status == status, f"{method} {path}: {reply.status}, expected {status}: {content[:300]!r}")
    try:
        text = json.dumps(json.loads(content)["error"], ensure_ascii=False)
    except (ValueError, KeyError):
        check(False, f"{method} {path}: the refusal is no JSON error: {content[:200]!r}")
        return
    for part in parts:
        check(part in text, f"{method} {path}: no {part!r} in {text}")


def api(program, source):
    """The document lists what is there; a scenario becomes a run with progress, series, files; it is renamed and removed."""
    with tempfile.TemporaryDirectory() as folder, Server(program, folder) as server:
        document = server.json("GET", "/api/openapi.json")
        check(document["openapi"] == "3.1.0", "the version of OpenAPI")
        reply, page = server.ask("GET", "/")
        check(reply.status == 200 and b"<title>Schuler</title>" in page, "the page is served")
        check("default-src 'none'" in reply.headers["Content-Security-Policy"], "the page has a policy")
        names = {o["key"] for o in server.json("GET", "/api/options")}
        listed = set(
            re.findall(
                r"^  ([a-z][a-z0-9_.]*)$",
                subprocess.run([program, "help", "scenario"], capture_output=True, text=True).stdout,
                re.M,
            )
        )
        check(listed <= names and len(listed) > 60, f"the form has the options of the help: {sorted(listed - names)}")
        check(all(o["help"] for o in server.json("GET", "/api/options?of=dataset")), "every option has a sentence")
        examples = {e["name"]: e["toml"] for e in server.json("GET", "/api/examples")}
        check(examples["demo"] == (Path(source) / "examples/demo.toml").read_text(), "the examples are those of the folder")

        now = server.json("POST", "/api/settings", {"toml": SMALL})
        check(now["problem"] is None and len(now["track"]["north_m"]) > 500, "a scenario comes with its track")
        check(now["settings"]["imu.grade"] == "tactical" and now["used"]["imu.gyro_bias_deg_h"] > 0, "presets are applied")
        again = server.json("POST", "/api/settings", {"settings": now["settings"]})
        check(again["toml"] == now["toml"], "settings and TOML are the same thing")
        wrong = server.json("POST", "/api/settings", {"settings": {"imu.rate_hz": -1}})
        check(
            wrong["problem"]["key"] == "imu.rate_hz" and "range" in wrong["problem"]["text"], "a wrong value is told with its key"
        )

        run = server.json(
            "POST", "/api/runs", {"kind": "scenario", "toml": SMALL, "title": "Small one", "output_rate_hz": 50}, 201
        )
        check(run["id"] == "small-one", "a run is named by its title")
        link = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
        link.request("GET", "/api/events", headers={"Authorization": f"Bearer {server.token}"})
        stream = link.getresponse()
        check(stream.headers["Content-Type"] == "text/event-stream", "the type of the events")
        states = []
        while not states or states[-1]["state"] in ("waiting", "running"):
            line = stream.readline()
            if line.startswith(b"data: "):
                states.append(json.loads(line[6:]))
        link.close()
        check(states[-1]["state"] == "done" and states[-1]["progress"] == 1.0, f"the events end with the run: {states[-1]}")
        check(any(0.0 < s["progress"] < 1.0 for s in states), "progress is told")
        check(any(s["stage"] == "filtering" and s["spent_s"] > 0 for s in states), f"and the stage: {states}")
        done = server.finished(run["id"])
        check(
            done["summary"]["reference"] == "truth" and {"report.html", "run.h5", "scenario.toml"} <= set(done["files"]),
            "the run has its files",
        )
        check("IMU epochs" in server.ask("GET", "/api/runs/small-one/log")[1].decode(), "the log is kept")

        groups = {g["group"]: g for g in server.json("GET", "/api/runs/small-one/channels")}
        check(
            {"/solution", "/errors", "/sensor_errors", "/sensor_truth", "/gnss", "/innovations/gnss_position"} <= set(groups),
            f"groups: {sorted(groups)}",
        )
        path = "/api/runs/small-one/series?columns=/errors/position:east,/errors/std_position:east"
        everything, thin = server.json("GET", path + "&points=0"), server.json("GET", path + "&points=100")
        check(not everything["thinned"] and thin["thinned"] and len(thin["time_s"]) < 500, "series are thinned")
        for column, values in everything["columns"].items():
            check(
                max(values) == max(thin["columns"][column]) and min(values) == min(thin["columns"][column]),
                f"{column}: extremes are kept",
            )
        part = server.json("GET", path + "&from=100&to=110&points=0")["time_s"]
        check(99.0 < part[0] <= 100.0 and 110.0 <= part[-1] < 111.0, "a range with one row beyond each end")

        other = server.json(
            "POST", "/api/runs", {"kind": "scenario", "toml": SMALL, "title": "Small one", "output_rate_hz": 50}, 201
        )
        check(other["id"] == "small-one-2", "a second run of that name has a folder of its own")
        server.finished(other["id"])
        difference = server.json("GET", "/api/runs/small-one/difference?with=small-one-2&points=50")
        check(all(v == 0 for v in difference["columns"]["difference:north"]), "the same scenario gives the same solution")
        check(server.json("PATCH", "/api/runs/small-one-2", {"title": "Друга"})["title"] == "Друга", "a run is renamed")
        reply, report = server.ask("GET", "/api/runs/small-one/files/report.html")
        check("sandbox" in reply.headers["Content-Security-Policy"] and b"<svg" in report, "the report is a page of its own")
        server.json("DELETE", "/api/runs/small-one-2")
        refused(server, "GET", "/api/runs/small-one-2", 404, ["no"])

        # every route of the document is there, and nothing else answers
        for path, operations in document["paths"].items():
            concrete = path.replace("{run}", "small-one").replace("{dataset}", "none").replace("{file}", "summary.json")
            if concrete == "/api/events":
                continue
            for method in operations:
                if method in ("delete", "post", "put", "patch"):
                    reply, content = server.ask(method.upper(), concrete, "{")
                    check(
                        reply.status in (400, 404, 409, 200) and b"of that name" not in content,
                        f"{method} {concrete}: {reply.status} {content[:100]!r}",
                    )
                else:
                    reply, content = server.ask("GET", concrete)
                    check(
                        b"of that name" not in content and reply.status != 405,
                        f"GET {concrete}: {reply.status} {content[:100]!r}",
                    )
        refused(server, "POST", "/api/about", 405, body="{}")


def raw_log(server, name):
    """The columns of a log as they are: few rows of everything, every row of a range, the units of their names."""
    path = f"/api/datasets/{name}/raw?file=imu.csv"
    few, all_rows = server.json("GET", path + "&points=500"), server.json("GET", path + "&points=0")
    check(few["thinned"] and len(few["time_s"]) < 1500 and few["rows"] > 5000, f"a log is thinned: {few['rows']}")
    check(not all_rows["thinned"] and len(all_rows["time_s"]) == few["rows"], "or every row is given")
    column = "dtheta_x_rad"
    for extreme in (min, max):
        check(extreme(few["columns"][column]) == extreme(all_rows["columns"][column]), "extremes are kept")
    check(few["units"][column] == "rad" and few["units"]["dv_z_m_s"] == "m/s", f"units: {few['units']}")
    part = server.json("GET", path + "&points=0&from=50&to=51")
    inside = [(t, x) for t, x in zip(all_rows["time_s"], all_rows["columns"][column]) if 50 <= t <= 51]
    check(list(zip(part["time_s"], part["columns"][column]))[1:-1] == inside, "a range with one row beyond each end")
    refused(server, "GET", path + "&points=x", 422)


def datasets(program, source):
    """Uploads become a data set that is looked at and processed; broken ones are told apart; failed runs leave no results."""
    with tempfile.TemporaryDirectory() as folder, Server(program, folder, "--max-upload", "8") as server:
        (Path(folder) / "s.toml").write_text(SMALL)
        subprocess.run([program, "simulate", "s.toml", "-o", "drive"], cwd=folder, check=True, capture_output=True)
        drive = Path(folder) / "drive"
        name = server.json("POST", "/api/datasets", {"title": "My drive"})["name"]
        check(name == "my-drive", "a data set is named by its title")
        for file in (f for f in drive.iterdir() if not f.name.startswith(".")):
            if file.name != "dataset.toml":
                server.json("PUT", f"/api/datasets/{name}/files/{file.name}", file.read_bytes(), 201)
        found = server.json("GET", f"/api/datasets/{name}/inspect")
        kinds = {f["path"]: f["kind"] for f in found["files"]}
        check(kinds.get("imu.csv") == "imu" and kinds.get("gnss.csv") == "gnss", f"what is in the files: {kinds}")
        check(found["form"]["problem"] is None and found["form"]["settings"]["imu.file"] == "imu.csv", "the form of a data set")
        raw_log(server, name)
        plain = server.finished(server.json("POST", "/api/runs", {"kind": "dataset", "dataset": name, "title": "plain"}, 201)["id"])
        check(server.json("GET", f"/api/runs/{plain['id']}/settings")["settings"] == {}, "a run without settings of its own")
        order = {"kind": "dataset", "dataset": name, "title": "cut", "settings": {"outage": [{"start_s": 110, "duration_s": 20}]}}
        done = server.finished(server.json("POST", "/api/runs", order, 201)["id"])
        check(done["state"] == "done" and len(done["summary"]["outages"]) == 1, f"the data set is processed: {done['message']}")

        # malformed files: told, never a crash
        for number, content in enumerate(
            [b"", b"\0" * 5000, b"time_s,gyro_x_rad_s\n1,nan\n" * 50, "час;швидкість\n1;2\n".encode(), os.urandom(20000)]
        ):
            bad = server.json("POST", "/api/datasets", {"title": f"bad {number}"})["name"]
            server.json("PUT", f"/api/datasets/{bad}/files/imu.csv", content, 201)
            reply, text = server.ask("GET", f"/api/datasets/{bad}/inspect")
            check(reply.status in (200, 422), f"malformed file {number}: {reply.status} {text[:200]!r}")
            order = server.json("POST", "/api/runs", {"kind": "dataset", "dataset": bad, "title": f"bad {number}"}, 201)
            end = server.finished(order["id"])
            check(
                end["state"] == "failed" and len(end["message"]) > 10,
                f"malformed file {number}: {end['state']} {end['message']!r}",
            )
            check("signal" not in end["message"], f"malformed file {number}: {end['message']}")
            check(set(end["files"]) <= {"settings.toml", "log.txt"}, f"a failed run leaves no results: {end['files']}")
        # bounds
        refused(server, "PUT", f"/api/datasets/{name}/files/big.bin", 413, ["8 MB", "--max-upload"], body=b"x" * (9 << 20))
        chunked = (
            f"PUT /api/datasets/{name}/files/big2.bin HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nAuthorization: Bearer {server.token}\r\nTransfer-Encoding: chunked\r\n\r\n"
        ).encode()
        piece = b"100000\r\n" + b"y" * 0x100000 + b"\r\n"
        check(b" 413 " in server.raw(chunked + piece * 9 + b"0\r\n\r\n", 20)[:100], "a stream without a length is bounded too")
        check(
            not any(p.name.startswith(("big", ".upload")) for p in (Path(folder) / "work/data" / name).iterdir()),
            "nothing is left of what was refused",
        )
        broken = server.raw(
            (
                f"PUT /api/datasets/{name}/files/half.csv HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nAuthorization: Bearer {server.token}\r\nContent-Length: 1000\r\n\r\nabc"
            ).encode(),
            15,
        )
        check(not (Path(folder) / "work/data" / name / "half.csv").exists(), f"half an upload has no name: {broken[:80]!r}")
        # a run that is cancelled
        long = SMALL.replace("duration_s = 150", "duration_s = 7000").replace("rate_hz = 50", "rate_hz = 400")
        run = server.json("POST", "/api/runs", {"kind": "scenario", "toml": long, "title": "long"}, 201)["id"]
        time.sleep(0.3)
        server.json("POST", f"/api/runs/{run}/cancel")
        end = server.finished(run)
        check(end["state"] == "cancelled" and "summary.json" not in end["files"], f"a cancelled run: {end['state']}")
        refused(server, "POST", f"/api/runs/{run}/cancel", 409)
        # a child that dies does not take the server down
        run = server.json("POST", "/api/runs", {"kind": "scenario", "toml": long, "title": "dies"}, 201)["id"]
        for _ in range(50):
            children = children_of(server.process.pid)
            if children:
                break
            time.sleep(0.1)
        os.kill(children[0], signal.SIGKILL)
        end = server.finished(run)
        check(end["state"] == "failed" and "signal" in end["message"], f"a run that dies: {end['state']} {end['message']!r}")
        check(server.json("GET", "/api/about")["version"], "the server lives on")


def hostile(program, source):
    """Foreign hosts and origins, paths that lead out, settings that name files elsewhere, requests that are no HTTP."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "secret.csv").write_text("secret")
        with Server(program, folder) as server:
            port = server.port
            refused(server, "GET", "/api/runs", 403, ["host"], host="evil.example")
            refused(server, "GET", "/api/runs", 403, ["host"], host=f"evil.example:{port}")
            refused(server, "GET", "/api/runs", 403, ["host"], host=f"192.168.1.7:{port}")
            refused(server, "GET", "/", 403, host="127.0.0.1:1")
            for host in (f"localhost:{port}", f"[::1]:{port}"):
                check(server.ask("GET", "/api/about", host=host)[0].status == 200, f"{host} is a name of this machine")
            for origin in ("http://evil.example", "null", f"https://127.0.0.1:{port}", f"http://127.0.0.1:{port}.evil.example"):
                refused(server, "POST", "/api/datasets", 403, ["another site"], body='{"title": "x"}', headers={"Origin": origin})
            refused(server, "GET", "/api/runs", 403, headers={"Sec-Fetch-Site": "cross-site"})
            server.json("POST", "/api/datasets", {"title": "ok"}, headers={"Origin": f"http://127.0.0.1:{port}"})
            check([d["name"] for d in server.json("GET", "/api/datasets")] == ["ok"], "what was refused has done nothing")
            # a refused request's body is not the next request
            inner = (
                f"POST /api/datasets HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAuthorization: Bearer {server.token}\r\nContent-Length: 19\r\n\r\n{{\"title\": \"hidden\"}}"
            )
            for kind in ("text/plain", "multipart/form-data; boundary=x"):
                outer = (
                    f"POST /api/datasets HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAuthorization: Bearer {server.token}\r\nOrigin: http://evil.example\r\n"
                    f"Content-Type: {kind}\r\nContent-Length: {len(inner)}\r\n\r\n"
                )
                server.raw((outer + inner).encode())
            server.raw(f"GET /api/about HTTP/1.1\r\nHost: evil\r\nContent-Length: {len(inner)}\r\n\r\n{inner}".encode())
            server.raw(
                f"POST /api/about HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAuthorization: Bearer {server.token}\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n{inner}".encode()
            )
            check([d["name"] for d in server.json("GET", "/api/datasets")] == ["ok"], "no request hides in another one's body")
            refused(
                server,
                "PUT",
                "/api/datasets/ok/files/a.csv",
                415,
                ["PUT"],
                body="--x\r\n\r\n--x--",
                headers={"Content-Type": "multipart/form-data; boundary=x"},
            )

            # names that lead out
            for name in (
                "..%2f..%2fsecret.csv",
                "%2e%2e",
                "..",
                ".hidden",
                "a%2f..",
                "a/../b",
                "a/%2e%2e/%2e%2e/%2e%2e/b",
                "a/.b",
                "a/b/c/d/e/f",
                "a%5cb",
                "%00",
                "x" * 200,
                "%c0%ae%c0%ae",
                "a%0ab",
            ):
                reply, content = server.ask("PUT", f"/api/datasets/ok/files/{name}", b"x")
                check(reply.status in (400, 404, 405, 414), f"the name {name} is refused: {reply.status} {content[:100]!r}")
                reply, content = server.ask("GET", f"/api/runs/{name}/files/secret.csv")
                check(
                    reply.status in (400, 404) and b"secret" not in content.replace(b"secret.csv", b""),
                    f"no file of {name}: {reply.status}",
                )
            work = Path(folder) / "work"
            check(sorted(p.name for p in work.rglob("*")) == [".server", "data", "ok"], f"nothing was written: {sorted(work.rglob('*'))}")
            (work / "data/ok/link").symlink_to(folder)
            os.symlink(Path(folder) / "secret.csv", work / "data/ok/link.csv")
            check(
                server.ask("PUT", "/api/datasets/ok/files/link.csv", b"x")[0].status == 404,
                "a link that leads out is not followed",
            )
            check((Path(folder) / "secret.csv").read_text() == "secret", "what it leads to is as it was")

            # settings that name files elsewhere
            for file in ("/etc/passwd", "../../../secret.csv", "$HOME/x", "~/x", "..\\\\x"):
                refused(
                    server,
                    "POST",
                    "/api/runs",
                    422,
                    ["leads out"],
                    {"kind": "dataset", "dataset": "ok", "settings": {"imu.file": file.replace("\\\\", "\\")}},
                )
                server.json("PUT", "/api/datasets/ok/files/dataset.toml", f'[imu]\nfile = "{file}"\n'.encode(), 201)
                refused(server, "POST", "/api/runs", 422, ["leads out"], {"kind": "dataset", "dataset": "ok"})
            server.json("PUT", "/api/datasets/ok/files/dataset.toml", b'[imu]\nfile = "link.csv"\n', 201)
            end = server.finished(
                server.json("POST", "/api/runs", {"kind": "dataset", "dataset": "ok", "title": "link"}, 201)["id"]
            )
            log = server.ask("GET", "/api/runs/link/log")[1]
            confined = server.json("GET", "/api/about")["confined"]
            check(
                end["state"] == "failed" and (not confined or b"secret\n" not in log),
                f"the child reads nothing outside: {end['message']}",
            )
            server.json("PUT", "/api/datasets/ok/files/kf.yaml", b"imupath: /etc/passwd\n", 201)
            server.json("PUT", "/api/datasets/ok/files/dataset.toml", b'[imu]\nfile = "imu.csv"\n', 201)
            refused(server, "POST", "/api/runs", 422, ["kf.yaml", "leads out"], {"kind": "dataset", "dataset": "ok"})

            (Path(folder) / "path.csv").write_text("secret")
            for file in ("/etc/passwd", "path.csv"):
                told = server.json("POST", "/api/settings", {"settings": {"trajectory.type": "file", "trajectory.file": file}})
                check(told["problem"]["key"] == "trajectory.file" and "track" not in told, f"no scenario reads {file}")
                refused(
                    server,
                    "POST",
                    "/api/runs",
                    422,
                    ["trajectory.file"],
                    {"settings": {"trajectory.type": "file", "trajectory.file": file}},
                )

            # bodies and addresses of no use
            for body in (
                "",
                "{",
                "[]",
                "null",
                '{"settings": 3}',
                '{"toml": 5}',
                '{"toml": "a = "}',
                '{"settings": {"nonsense": 1}}',
                "\xff" * 10,
            ):
                reply, content = server.ask("POST", "/api/settings", body.encode("latin-1"))
                check(400 <= reply.status < 500 and b"error" in content, f"{body!r}: {reply.status} {content[:100]!r}")
            refused(server, "POST", "/api/settings", 413, ["4 MB"], body=b" " * (5 << 20))
            deep = "[" * 100000
            check(server.ask("POST", "/api/settings", deep)[0].status == 400, "deeply nested JSON")
            check(server.json("GET", "/api/about")["version"], "and the server lives")
            for query in (
                "columns=",
                "columns=a",
                "columns=/../x:y",
                "columns=/solution/position:lat&points=-1",
                "columns=/x/y:z&from=nan",
                "columns=" + ",".join(["/a/b:c"] * 100),
            ):
                check(server.ask("GET", f"/api/runs/none/series?{query}")[0].status in (404, 414, 422), query[:60])
            for data in (
                b"\r\n\r\n",
                b"GET\r\n\r\n",
                b"\x16\x03\x01" + os.urandom(300),
                b"GET / HTTP/9.9\r\n\r\n",
                b"GET /" + b"a" * 7000 + b" HTTP/1.1\r\nHost: x\r\n\r\n",
                b"GET /" + b"b" * 100000,
                b"GET / HTTP/1.1\r\nRange: bytes=" + b"0-1," * 1900 + b"0-1\r\n\r\n",
                b"TRACE / HTTP/1.1\r\nHost: x\r\n\r\n",
                b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 5000 + b"\r\n",
            ):
                out = server.raw(data, 12)
                check(b" 200 " not in out[:20], f"{data[:20]!r}: {out[:60]!r}")
            check(server.json("GET", "/api/about")["version"], "the server lives through all of it")

        for options in ([], ["--host", "0.0.0.0"]):
            with Server(program, folder, *options) as server:
                check(len(server.token) == 32, f"a server has a token: {server.line}")
                nobody = {"Authorization": None}
                refused(server, "GET", "/api/runs", 401, ["token"], headers=nobody)
                refused(server, "GET", "/", 401, ["token"], headers=nobody)
                refused(server, "GET", "/api/runs", 401, headers={"Authorization": "Bearer " + "0" * 32})
                refused(server, "GET", "/?token=" + "0" * 32, 401, headers=nobody)
                refused(server, "GET", "/api/runs", 403, host=f"evil.example:{server.port}")
                check(server.ask("GET", "/api/runs")[0].status == 200, "the token opens")
                reply, _ = server.ask("GET", f"/?token={server.token}", headers=nobody)
                cookie = reply.headers["Set-Cookie"] or ""
                check(
                    reply.status == 303 and reply.headers["Location"] == "/" and "HttpOnly" in cookie and "SameSite=Strict" in cookie,
                    f"the token becomes a cookie: {cookie}",
                )
                mine = {**nobody, "Cookie": cookie.split(";")[0]}
                check(server.ask("GET", "/api/runs", headers=mine)[0].status == 200, "the cookie opens")



def main(topics):
    parser = argparse.ArgumentParser()
    parser.add_argument("topic", choices=topics)
    parser.add_argument("--program", required=True)
    parser.add_argument("--source", required=True)
    options = parser.parse_args()
    topics[options.topic](options.program, options.source)
    print(f"{options.topic}: {len(FAILURES)} failures")
    return 1 if FAILURES else 0


if __name__ == "__main__":
    sys.exit(main({"api": api, "datasets": datasets, "hostile": hostile}))
