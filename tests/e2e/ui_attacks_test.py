"""Bodies that exhaust, damaged results, clients that send slowly: the server lives and answers others meanwhile."""
import http.client
import json
import os
import random as numbers
import socket
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

from program_test import check
from ui_server_test import SMALL, Server, children_of, main, refused

SURVEY = """duration_s = 60
[trajectory]
type = "survey"
start = { lat_deg = 48, lon_deg = 15, height_m = 700 }
speed_m_s = 60
survey = { lines = LINES, ties = LINES, length_m = LENGTH, spacing_m = 100, overrun_m = 10, bank_deg = 15 }
"""


def small_survey(more):
    return SURVEY.replace("LINES", "2").replace("LENGTH", "2000") + more


def naming(file):
    """Settings that name a file: each key that a scenario may have one in."""
    return [small_survey(f'[anomaly_field]\nfile = "{file}"\n'), small_survey(f'drape = {{ clearance_m = 100, file = "{file}" }}\n')]


class Memory(threading.Thread):
    """Largest memory that a child of the process has had, MB."""

    def __init__(self, parent):
        super().__init__(daemon=True)
        self.parent, self.peak, self.seen, self.on = parent, 0.0, 0, True

    def run(self):
        while self.on:
            for child in children_of(self.parent):
                try:
                    status = Path(f"/proc/{child}/status").read_text()
                except OSError:
                    continue
                for line in status.splitlines():
                    if line.startswith("VmHWM:"):
                        self.peak = max(self.peak, int(line.split()[1]) / 1024)
                        self.seen += 1
            time.sleep(0.01)


def attacks(program, source):
    with tempfile.TemporaryDirectory() as folder, Server(program, folder) as server:
        port, auth = server.port, f"Authorization: Bearer {server.token}\r\n"
        # deep and endless settings
        refused(server, "POST", "/api/settings", 422, ["parts"], body={"toml": "a." * 10_000 + "a = 1"})
        (Path(folder) / "secret.csv").write_text("lat_deg,lon_deg,east_mgal,north_mgal,up_mgal\n1,2,3,4,secret\n")
        os.mkfifo(Path(folder) / "pipe.csv")
        begin = time.monotonic()
        for file in ("secret.csv", "pipe.csv", "none.csv"):
            for toml in naming(file):
                problem = server.json("POST", "/api/settings", {"toml": toml})["problem"] or {"text": ""}
                check("secret\"" not in json.dumps(problem) and "up_mgal" not in problem["text"], f"nothing of {file} is told: {problem}")
                check("no such file" in problem["text"], f"files of the server's own folder are not there: {toml} {problem}")
        for file in ("/etc/passwd", "../secret.csv", "~/x.csv"):
            for toml in naming(file):
                problem = server.json("POST", "/api/settings", {"toml": toml})["problem"] or {"text": ""}
                check("leads out" in problem["text"], f"{file}: {problem}")
        memory = Memory(server.process.pid)
        memory.start()
        reply, content = server.ask("POST", "/api/settings", {"toml": SURVEY.replace("LINES", "1000").replace("LENGTH", "1e6")})
        memory.on = False
        memory.join()
        check(reply.status in (200, 422), f"an endless preview: {reply.status} {content[:200]!r}")
        check(memory.seen > 0 and memory.peak < 1100, f"a preview's process: {memory.peak:.0f} MB in {memory.seen} looks at it")
        check(time.monotonic() - begin < 60, "in time")

        # what a browser keeps of the page, and asks for again
        for path in ("/", "/assets/main.js", "/assets/first.js"):
            reply, script = server.ask("GET", path)
            tag = reply.headers["ETag"]
            check(reply.headers["Cache-Control"] == "no-cache", f"{path} is kept, and asked for each time")
            again, nothing = server.ask("GET", path, headers={"If-None-Match": tag})
            check(again.status == 304 and nothing == b"" and again.headers["ETag"] == tag, f"{path} is not sent again: {again.status}")
            old, whole = server.ask("GET", path, headers={"If-None-Match": '"0123456789abcdef"'})
            check(old.status == 200 and whole == script and len(script) > 500, f"another {path} is sent again")
            stranger, _ = server.ask("GET", path, headers={"If-None-Match": tag, "Authorization": None})
            check(stranger.status == 401, f"{path}: who has no token is not told that it is the same: {stranger.status}")
        reply, _ = server.ask("GET", "/api/runs")
        check(reply.headers["Cache-Control"] == "no-store" and reply.headers["ETag"] is None, "what the interface says is not kept")

        # a run whose results are damaged, byte by byte
        run = server.json("POST", "/api/runs", {"kind": "scenario", "toml": SMALL, "title": "x"}, 201)["id"]
        server.finished(run)
        file = Path(folder) / "work" / run / "run.h5"
        whole = file.read_bytes()
        check(server.ask("GET", f"/api/runs/{run}/channels")[0].status == 200, "channels of a sound run")
        random = numbers.Random(3)
        for at in [707, *(random.randrange(len(whole)) for _ in range(12))]:
            damaged = bytearray(whole)
            damaged[at] ^= 0xFF
            file.write_bytes(damaged)
            reply, _ = server.ask("GET", f"/api/runs/{run}/channels")
            check(reply.status in (200, 422), f"byte {at} damaged: {reply.status}")
        check(server.json("GET", "/api/about")["version"], "the server lives")

        # clients that say nothing, and bodies that come a byte at a time
        slow = [socket.create_connection(("127.0.0.1", port)) for _ in range(150)]
        for n in range(30):
            link = socket.create_connection(("127.0.0.1", port))
            link.sendall(f"POST /api/settings HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{auth}Content-Length: 100000\r\n\r\n{{".encode())
            slow.append(link)
        answered(server, "silent clients")
        for link in slow:
            link.close()


def answered(server, what, limit=2.0):
    begin = time.monotonic()
    try:
        status = server.ask("GET", "/api/about")[0].status
    except OSError as error:
        status = error
    check(status == 200 and time.monotonic() - begin < limit, f"{what}: others are answered meanwhile: {status} after {time.monotonic() - begin:.1f} s")


def crowd(program, source):
    """More clients than threads, each with a byte a second of its head or of a body without the token: who has the token is answered; the
    head is waited for ten seconds in all; SIGTERM ends the server with all of them there, and with requests that name a FIFO."""
    with tempfile.TemporaryDirectory() as folder, Server(program, folder) as server:
        links, on = [], True

        def drip(text):
            """A client of its own, from the first byte on."""
            link = socket.create_connection(("127.0.0.1", server.port), timeout=30)
            link.sendall(text)
            link.setblocking(False)
            links.append(link)

        def drops():
            while on:
                for link in list(links):
                    try:
                        link.send(b"x")
                    except OSError:
                        pass
                time.sleep(1.0)

        dripping = threading.Thread(target=drops, daemon=True)
        dripping.start()
        for n in range(300):
            drip(b"GET /api/about HTTP/1.1\r\nX-Slow: " if n % 2 else f"POST /api/settings HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nContent-Length: 100000\r\n\r\n{{".encode())
        for _ in range(5):
            answered(server, "300 clients that drip")
        drip(b"GET /api/about HTTP/1.1\r\nX-Slow: ")
        newest, begin = links[-1], time.monotonic()   # the oldest have made room: nobody came after this one
        while time.monotonic() - begin < 20:
            try:
                if newest.recv(4096) == b"":
                    break
            except BlockingIOError:
                time.sleep(0.1)
            except OSError:
                break
        check(7 < time.monotonic() - begin < 15, "a head that is not complete after ten seconds is the end of a connection")
        for _ in range(100):
            drip(b"GET / HTTP/1.1\r\nX-Endless: ")
        endless = socket.create_connection(("127.0.0.1", server.port), timeout=10)
        sent = 0
        try:
            for _ in range(1000):
                sent += endless.send(b"X-Header: " + b"y" * 1000 + b"\r\n") if sent else endless.send(b"GET / HTTP/1.1\r\n")
                time.sleep(0.001)
        except OSError:
            pass
        check(sent < 900_000, f"a head without end was taken: {sent} bytes")

        os.mkfifo(Path(folder) / "pipe.csv")
        os.mkfifo(Path(folder) / "work" / "pipe.csv")
        done = []

        def ask(toml):
            try:
                done.append(server.ask("POST", "/api/settings", {"toml": toml})[0].status)
            except (OSError, http.client.HTTPException):   # cut off: an end too
                done.append(None)
        both = naming("pipe.csv")
        asking = [threading.Thread(target=ask, args=(both[n % 2],), daemon=True) for n in range(24)]
        asking += [threading.Thread(target=ask, args=(SURVEY.replace("LINES", "1000").replace("LENGTH", "1e6"),), daemon=True) for n in range(2)]
        for thread in asking:
            thread.start()
        time.sleep(0.2)
        begin = time.monotonic()
        server.process.send_signal(signal.SIGTERM)
        check(server.process.wait(timeout=30) == 0 and time.monotonic() - begin < 2, f"SIGTERM is answered after {time.monotonic() - begin:.1f} s")
        on = False
        for thread in asking:
            thread.join(20)
        check(len(done) == len(asking), "every request has an end")


if __name__ == "__main__":
    sys.exit(main({"attacks": attacks, "crowd": crowd}))
