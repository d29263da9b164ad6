"""Table of a coverage report of gcovr: a room a row, then the files with most lines that no test reaches.

    coverage_table.py COVERAGE.json [--missing]        --missing: also the numbers of those lines
"""
import json
import sys
from collections import defaultdict
from pathlib import Path


def counts(file):
    """Lines, those reached, branches, those taken, numbers of lines that were not reached."""
    lines = [line for line in file["lines"] if not line.get("gcovr/noncode") and not line.get("gcovr/excluded")]
    branches = [branch for line in lines for branch in line.get("branches", []) if not branch.get("throw")]
    return (len(lines), sum(line["count"] > 0 for line in lines), len(branches), sum(branch["count"] > 0 for branch in branches),
            sorted({line["line_number"] for line in lines if line["count"] == 0}))


def percent(part, whole):
    return 100.0 * part / whole if whole else 100.0


def spans(numbers):
    """1, 2, 3, 7 -> 1-3 7."""
    runs = []
    for number in numbers:
        if runs and runs[-1][1] == number - 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return " ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def main():
    files = {entry["file"]: counts(entry) for entry in json.loads(Path(sys.argv[1]).read_text())["files"]}
    rooms = defaultdict(lambda: [0, 0, 0, 0])
    for name, found in files.items():
        for key in (Path(name).parts[2], "all"):
            rooms[key] = [a + b for a, b in zip(rooms[key], found[:4])]
    print("| room | lines | reached, % | branches | taken, % |\n|---|---|---|---|---|")
    for room, (lines, reached, branches, taken) in sorted(rooms.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"| {room} | {lines} | {percent(reached, lines):.1f} | {branches} | {percent(taken, branches):.1f} |")
    print("\n| file | lines not reached | branches not taken |" + (" which lines |" if "--missing" in sys.argv else "") + "\n|---|---|---|")
    for name, (lines, reached, branches, taken, missing) in sorted(files.items(), key=lambda item: item[1][1] - item[1][0])[:40]:
        print(f"| {name.removeprefix('src/schuler/')} | {lines - reached} of {lines} | {branches - taken} of {branches} |"
              + (f" {spans(missing)} |" if "--missing" in sys.argv else ""))


if __name__ == "__main__":
    main()
