#!/bin/sh
# Forward/backward separation over seeds of a scenario, undisturbed: a line a seed, then the means. The table in docs/outputs.md.
#   scripts/separation.sh SCHULER SCENARIO SEEDS [ARGS...]
set -eu
program=$1 scenario=$2 seeds=$3
shift 3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
seed=1
while [ "$seed" -le "$seeds" ]; do
    nice "$program" run "$scenario" --backward --outputs summary --seed "$seed" -o "$folder/$seed" -q "$@"
    seed=$((seed + 1))
done
python3 - "$folder" <<'PYTHON'
import json, math, sys
from pathlib import Path
keys = ("north_m", "east_m", "up_m", "heading_deg")
rows = [json.loads(file.read_text())["separation"] for file in sorted(Path(sys.argv[1]).glob("*/summary.json"), key=lambda f: int(f.parent.name))]
print(f"{'':6}" + "".join(f"{key:>22}" for key in keys))
def line(name, values):
    print(f"{name:6}" + "".join(f"{rms:14.4g}{100 * inside:6.1f} %" for rms, inside in values))
for seed, row in enumerate(rows, 1):
    line(str(seed), [(row[key]["rms"], row[key]["inside_3sigma"]) for key in keys])
line("all", [(math.sqrt(sum(row[key]["rms"] ** 2 for row in rows) / len(rows)), sum(row[key]["inside_3sigma"] for row in rows) / len(rows)) for key in keys])
PYTHON
