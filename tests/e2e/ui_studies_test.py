"""The studies of the program behind the page: every one has a form, and what the form says is what is run."""
import json
import sys
import tempfile

from ui_server_test import SMALL, Server, check, main, refused


def studies(program, source):
    with tempfile.TemporaryDirectory() as folder, Server(program, folder) as server:
        all_of_them = {s["command"]: s for s in server.json("GET", "/api/studies")}
        check({"analyze equator", "analyze schuler", "analyze requirements", "analyze budget", "analyze integrity", "analyze triad",
               "analyze allan", "analyze protection", "analyze observability"} <= set(all_of_them), f"studies: {list(all_of_them)}")
        speed = {o["key"]: o for o in all_of_them["analyze equator"]["options"]}["speed"]
        check(speed["unit"] == "m/s" and speed["default"] == 0 and speed["shape"] == "number", f"a field: {speed}")
        accepted = {name: all_of_them[name]["accepts"] for name in ("analyze budget", "analyze allan", "receiver track", "receiver generate", "analyze equator")}
        check(list(accepted.values()) == [["scenario"], ["scenario", "dataset"], ["recording"], [], []], f"what a study works on: {accepted}")
        for study in all_of_them.values():
            check(not {"output", "set", "config", "scenario"} & {o["key"] for o in study["options"]}, f"no field names a file: {study['command']}")

        run = server.json("POST", "/api/studies", {"command": "analyze equator", "title": "East", "settings": {"speed": 600, "dh": 1}}, 201)["id"]
        done = server.finished(run)
        check(done["state"] == "done" and "speed_limit_m_s" in (done["summary"] or {}), f"what it found is the summary: {json.dumps(done)[:400]}")
        order = {"command": "analyze budget", "settings": {"runs": 1, "jobs": 1}, "scenario": {"toml": SMALL}}
        done = server.finished(server.json("POST", "/api/studies", order, 201)["id"])
        check(done["state"] == "done" and done["summary"], f"a study of a scenario: {json.dumps(done)[:400]}")

        papers = {p["paper"]: [i["item"] for i in p["items"]] for p in server.json("GET", "/api/papers")}
        check(set(papers) == set("ABCDE") and "figure-4.1.1" in papers["A"], f"items of the papers: {papers.keys()}")
        order = {"command": "paper", "settings": {"item": "figure-4.1.1", "paper": "A"}}
        done = server.finished(server.json("POST", "/api/studies", order, 201)["id"])
        rows = {r["key"]: r["agreement"] for r in (done["summary"] or {}).get("rows", [])}
        check(done["state"] == "done" and rows.get("period") == "agrees" and "report.html" in done["files"], f"an item of a paper: {json.dumps(done)[:400]}")
        refused(server, "POST", "/api/studies", 422, ["paper"], body='{"command": "paper", "settings": {"item": "figure-4.1.1"}}')
        refused(server, "POST", "/api/studies", 422, ["item"], body='{"command": "paper", "settings": {"paper": "A", "item": "--help"}}')

        receiver(server)
        refused(server, "POST", "/api/studies", 422, ["not a study"], body='{"command": "process"}')
        refused(server, "POST", "/api/studies", 422, ["speed", "number"], body='{"command": "analyze equator", "settings": {"speed": "fast"}}')
        refused(server, "POST", "/api/studies", 422, ["spead", "speed"], body='{"command": "analyze equator", "settings": {"spead": 1}}')
        refused(server, "POST", "/api/studies", 422, ["output"], body='{"command": "analyze equator", "settings": {"output": "/tmp/x"}}')
        refused(server, "POST", "/api/studies", 422, ["scenario"], body='{"command": "analyze budget"}')


def receiver(server):
    """A recording is made by one run and tracked by another; nothing outside the workspace is, and no file of any size is made."""
    order = {"command": "receiver generate", "settings": {"seconds": 3, "sample-rate": 2.5e6, "satellites": ["G07:48:1200:300.5"]}}
    made = server.finished(server.json("POST", "/api/studies", order, 201)["id"])
    check(made["state"] == "done" and "recording.ibyte" in made["files"], f"a recording: {json.dumps(made)[:400]}")
    order = {"command": "receiver track", "settings": {"sample-rate": 2.5e6, "satellites": ["G07", "G08"]}, "recording": {"run": made["id"]}}
    done = server.finished(server.json("POST", "/api/studies", order, 201)["id"])
    found = [s["satellite"] for s in (done["summary"] or {}).get("satellites", []) if s["found"]]
    check(found == ["G07"] and "report.html" in done["files"], f"its satellites: {json.dumps(done)[:400]}")
    for recording in ({}, {"run": "none"}, {"run": done["id"]}, {"run": ".."}, {"dataset": "none", "file": "x"}, {"dataset": "..", "file": "../x"}):
        status = server.ask("POST", "/api/studies", {**order, "recording": recording})[0].status
        check(status in (400, 404, 422), f"no recording: {recording}: {status}")
    refused(server, "POST", "/api/studies", 422, ["sample-rate"], body=json.dumps({**order, "settings": {}}))
    refused(server, "POST", "/api/studies", 413, ["MB"], body='{"command": "receiver generate", "settings": {"seconds": 3600}}')


if __name__ == "__main__":
    sys.exit(main({"studies": studies}))
