#!/usr/bin/env python3
"""Writes docs/papers.md and its pictures from what `schuler paper` makes: papers_document.py --schuler build/bin/schuler [--docs docs]"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

INKS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 460, 200, 64, 34, 26


def run(program, *arguments):
    done = subprocess.run([program, "paper", *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    return done.stdout


def thinned(points, most=120):
    return points[:: max(1, len(points) // most)] + points[-1:]


def escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def picture(folder):
    """The first plot of an item as a small SVG; None without curves."""
    file = folder / "curves.csv"
    if not file.exists():
        return None
    curves, first = {}, None
    with open(file, encoding="utf-8") as rows:
        for row in csv.DictReader(rows):
            first = first or row["plot"]
            if row["plot"] == first and row["curve"]:
                curves.setdefault(row["curve"], []).append((float(row["x"]), float(row["y"])))
    xs = [x for c in curves.values() for x, _ in c]
    ys = sorted(y for c in curves.values() for _, y in c)
    cut = len(ys) // 100  # a start-up would rule the scale
    low, high, left, right = ys[cut], ys[-1 - cut], min(xs), max(xs)
    title = first if len(first) < 64 else first[: first.rfind(" ", 0, 62)] + " ..."
    margin = 0.05 * (high - low) or 1.0
    low, high = low - margin, high + margin

    def place(x, y):
        y = min(max(y, low), high)
        return (LEFT + (x - left) / ((right - left) or 1.0) * (WIDTH - LEFT - 8), HEIGHT - BOTTOM - (y - low) / (high - low) * (HEIGHT - BOTTOM - TOP))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="10">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/><text x="{LEFT}" y="14" font-size="11">{escaped(title)}</text>',
           f'<rect x="{LEFT}" y="{TOP}" width="{WIDTH - LEFT - 8}" height="{HEIGHT - BOTTOM - TOP}" fill="none" stroke="#999"/>']
    for share in (0.0, 0.5, 1.0):
        x, y = left + share * (right - left), low + share * (high - low)
        anchor = "end" if share == 1.0 else "middle"
        out.append(f'<text x="{place(x, low)[0]:.0f}" y="{HEIGHT - BOTTOM + 12}" text-anchor="{anchor}">{x:.4g}</text>')
        out.append(f'<text x="{LEFT - 4}" y="{place(left, y)[1] + 3:.0f}" text-anchor="end">{y:.3g}</text>')
    legend = LEFT
    for i, (name, points) in enumerate(curves.items()):
        ink = INKS[i % len(INKS)]
        line = " ".join("{:.1f},{:.1f}".format(*place(x, y)) for x, y in thinned(points))
        out.append(f'<polyline points="{line}" fill="none" stroke="{ink}" stroke-width="1.2"/>')
        if name and legend < WIDTH - 60:
            out.append(f'<text x="{legend}" y="{HEIGHT - 6}" fill="{ink}">{escaped(name[:34])}</text>')
            legend += 6 * min(len(name), 34) + 10
    return "\n".join(out) + "\n</svg>\n"


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
                        if remark in ("misprint", "explained"):
                            remark += f": right is {row['right']:.4g}; {row['remark']}"
                        text.append(f"| {row['quantity']} | {row['unit']} | {row['statement'].replace('<=', '≤').replace('>=', '≥')} | {number(row['ours'])} | {remark} |".replace("|beta|", "beta"))
                    text.append("")
                drawn = picture(folder)
                if drawn:
                    file = f"{paper.lower()}-{name}.svg"
                    (pictures / file).write_text(drawn, encoding="utf-8")
                    text += [f"![{item['what']}](papers/{file})", ""]
    (arguments.docs / "papers.md").write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
