"""Bodies that exhaust, damaged results, clients that send slowly: the server lives and answers others meanwhile."""
import json
import os
import random as numbers
import socket
import sys
import tempfile
import time
from pathlib import Path

from program_test import check
from ui_server_test import SMALL, Server, main, refused


def attacks(program, source):
    with tempfile.TemporaryDirectory() as folder, Server(program, folder) as server:
        port, auth = server.port, f"Authorization: Bearer {server.token}\r\n"
        # deep and endless settings
        refused(server, "POST", "/api/settings", 422, ["parts"], body={"toml": "a." * 10_000 + "a = 1"})
        (Path(folder) / "secret.csv").write_text("lat_deg,lon_deg,east_mgal,north_mgal,up_mgal\n1,2,3,4,secret\n")
        os.mkfifo(Path(folder) / "pipe.csv")
        survey = """duration_s = 60
[trajectory]
type = "survey"
start = { lat_deg = 48, lon_deg = 15, height_m = 700 }
speed_m_s = 60
survey = { lines = LINES, ties = LINES, length_m = LENGTH, spacing_m = 100, overrun_m = 10, bank_deg = 15 }
"""
        begin = time.monotonic()
        for file in ("secret.csv", "pipe.csv", "none.csv"):
            toml = survey.replace("LINES", "2").replace("LENGTH", "2000") + f'[anomaly_field]\nfile = "{file}"\n'
            problem = server.json("POST", "/api/settings", {"toml": toml})["problem"] or {"text": ""}
            check("secret\"" not in json.dumps(problem) and "up_mgal" not in problem["text"], f"nothing of {file} is told: {problem}")
            check("no such file" in problem["text"], f"files of the server's own folder are not there: {file} {problem}")
        reply, content = server.ask("POST", "/api/settings", {"toml": survey.replace("LINES", "1000").replace("LENGTH", "1e6")})
        check(reply.status in (200, 422), f"an endless preview: {reply.status} {content[:200]!r}")
        check(time.monotonic() - begin < 40, "in time")

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
        begin = time.monotonic()
        check(server.ask("GET", "/api/about")[0].status == 200 and time.monotonic() - begin < 5, "others are answered meanwhile")
        for link in slow:
            link.close()



if __name__ == "__main__":
    sys.exit(main({"attacks": attacks}))
