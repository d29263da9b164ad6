"""scripts/mutate.py finds what it is to change, leaves alone what is no code, and stops where a pattern of files matches nothing.

    mutations.py ROOT
"""
import importlib.util
import re
import sys
import tempfile
from pathlib import Path

root = Path(sys.argv[1]).resolve()
spec = importlib.util.spec_from_file_location("mutate", root / "scripts/mutate.py")
mutate = importlib.util.module_from_spec(spec)
sys.dont_write_bytecode = True
spec.loader.exec_module(mutate)
failures = []


def changes(line):
    with tempfile.NamedTemporaryFile("w", suffix=".cpp") as file:
        file.write(line + "\n")
        file.flush()
        return {changed for _, changed in mutate.sites(Path(file.name))}


for line, expected in (
    ("a = b + c;", {"a = b - c;"}),
    ("a += b;", {"a -= b;"}),
    ("f(-w);", {"f(w);"}),
    ("return -w;", {"return w;"}),
    ("a = 0.5 * b;", {"a = 0.75 * b;", "a = 0.5 / b;"}),
    ("a = b / c;", {"a = b * c;"}),
    ("a = 1e-3;", {"a = 0.0015;"}),
    ("a = 6.5e7;", {"a = 97500000.0;"}),
    ("word = bits >> 24;", {"word = bits << 24;", "word = bits >> 25;"}),
    ("word = 1 << n;", {"word = 1 >> n;"}),
    ("mask(0x3F);", {"mask(0x40);"}),
    ("if (a <= b) return;", {"if (a > b) return;"}),
    ("if (a == b || c) return;", {"if (a != b || c) return;", "if (a == b && c) return;"}),
    ("a = v.x();", {"a = v.y();"}),
    ("a = v.y();", {"a = v.z();"}),
    ("std::array<double, 3> a;", {"std::array<double, 4> a;"}),
    ("int32_t a2 = x3;", set()),
    ("x = 48'000'000;", set()),
    ('log("a + b");  // a + b', set()),
    ("#include <a + b>", set()),
    ("throw input_error(a + b);", set()),
    ("a = b;  // c + d", set()),
):
    found = changes(line)
    if found != expected:
        failures.append(f"{line}: {sorted(found)} instead of {sorted(expected)}")

# every kind of change is found somewhere, and every pattern of files matches files
places = {room: [(file, *site) for file in mutate.files_of(room) for site in mutate.sites(file)] for room in mutate.ROOMS}
for room, found in places.items():
    if len(found) < 100:
        failures.append(f"{room}: only {len(found)} places")
for folder in ("filter/states", "filter/update", "filter/integrity", "filter/stream", "filter/measurement", "io/receiver/detail", "io/container"):
    room = folder.split("/")[0]
    if not any(file.is_relative_to(root / "src/schuler" / folder) for file, *_ in places[room]):
        failures.append(f"nothing in {folder} is changed")
if not any(re.search("leap|1980", line) for file, *_ in places["core"] for line in [file.read_text()]):
    failures.append("the leap seconds are in no file of core")
mutate.ROOMS["nowhere"] = (["nowhere/*.cpp"], [])
try:
    mutate.files_of("nowhere")
    failures.append("a pattern that matches nothing passes")
except SystemExit as stop:
    if "nowhere/*.cpp" not in str(stop):
        failures.append(f"the pattern is not named: {stop}")
print("\n".join(failures) or f"{sum(map(len, places.values()))} places")
sys.exit(1 if failures else 0)
