#!/usr/bin/env python3
"""Writes docs/papers.md and its pictures from what `schuler paper` makes: papers_document.py --schuler build/bin/schuler [--docs docs]"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402  (after the choice of what draws)

# Text stays text, and the same data give the same bytes.
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "schuler", "font.size": 8, "axes.grid": True, "grid.color": "#e0e0e0", "grid.linewidth": 0.6,
                            "axes.prop_cycle": matplotlib.cycler(color=["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"])})


def run(program, *arguments):
    done = subprocess.run([program, "paper", *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    return done.stdout


def thinned(points, most=120):
    return points[:: max(1, len(points) // most)] + points[-1:]


def picture(folder, plots, target):
    """Draws the first plot of an item; False where it has no curves."""
    file = folder / "curves.csv"
    if not file.exists():
        return False
    plot, curves = plots[0], {}
    with open(file, encoding="utf-8") as rows:
        for row in csv.DictReader(rows):
            if row["plot"] == plot["title"]:
                curves.setdefault(row["curve"], []).append((float(row["x"]), float(row["y"] or "nan")))
    if not curves:
        return False
    figure, axes = pyplot.subplots(figsize=(5.6, 2.7), layout="constrained")
    for name, points in curves.items():
        axes.plot(*zip(*thinned(points)), linewidth=1.1, label=name or None)
    axes.set_title(plot["title"], fontsize=8, loc="left", wrap=True)
    axes.set_xlabel(plot["x"])
    axes.set_ylabel(plot["y"])
    if plot["log_y"]:
        axes.set_yscale("log")
    elif not plot["equal_axes"]:   # a start-up would rule the scale
        values = sorted(y for points in curves.values() for _, y in points if y == y)
        cut = len(values) // 100
        low, high = values[cut], values[-1 - cut]
        margin = 0.06 * (high - low) or 1.0
        axes.set_ylim(low - margin, high + margin)
    else:
        axes.set_aspect("equal", adjustable="datalim")
    if any(curves):
        axes.legend(fontsize=7, framealpha=0.8)
    figure.savefig(target, metadata={"Date": None, "Creator": None})
    pyplot.close(figure)
    return True


def number(x):
    return "-" if x is None else f"{x:.4g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--schuler", default="build/bin/schuler")
    parser.add_argument("--docs", type=Path, default=Path("docs"))
    arguments = parser.parse_args()
    pictures = arguments.docs / "papers"
    pictures.mkdir(exist_ok=True)
    text = ["# The papers, beside what this program gives", "",
            "Made by `scripts/papers_document.py`; not to be edited by hand. `schuler paper A` lists the items of a paper, `schuler paper A ITEM -o DIR` makes one",
            "with all of its plots. What is printed stands in [data/papers.toml](../data/papers.toml), pages with it. Seed 1.", ""]
    with tempfile.TemporaryDirectory() as scratch:
        for paper in "ABCDE":
            listed = json.loads(run(arguments.schuler, paper, "--json"))["items"]
            text += [f"## Paper {paper}", ""]
            for item in listed:
                name, folder = item["item"], Path(scratch) / paper / item["item"]
                made = json.loads(run(arguments.schuler, paper, name, "-o", folder, "--json"))
                runs = f", {made['runs']} runs" if item["runs"] else ""
                text += [f"### {paper} {name}: {item['what']}", "", f"Page {item['page']}; {item['place']}{runs}.", ""]
                if made["rows"]:
                    text += ["| | unit | printed | ours | |", "|---|---|---|---|---|"]
                    for row in made["rows"]:
                        remark = row["agreement"]
                        if remark == "agrees" and not row["exact"]:
                            remark += " within its tolerance"
                        if remark in ("misprint", "explained"):
                            remark += f": right is {row['right']:.4g}; {row['remark']}"
                        text.append(f"| {row['quantity']} | {row['unit']} | {row['statement'].replace('<=', '≤').replace('>=', '≥')} | {number(row['ours'])} | {remark} |".replace("|beta|", "beta"))
                    text.append("")
                file = f"{paper.lower()}-{name}.svg"
                if made["plots"] and picture(folder, made["plots"], pictures / file):
                    text += [f"![{item['what']}](papers/{file})", ""]
    (arguments.docs / "papers.md").write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
