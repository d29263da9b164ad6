#!/usr/bin/env bash
# The documents as a site: README.md as its first page, docs/*.md, the changelog, and the pages of the Python package made of its
# docstrings, and where Doxygen is there the C++ interface made of the headers. Links between pages, and to their sections, are checked: a
# broken one is an error.
#
#   scripts/site.sh OUT_FOLDER [BUILD_FOLDER]        the build folder's Python package, where it has one
#
# Needs mkdocs, and for the C++ interface doxygen (scripts/packages.sh --install site). Nothing is loaded from the network when the site is read.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$(realpath -m "${1:?folder for the site}")
build=$(realpath -m "${2:-$root/build}")
command -v mkdocs >/dev/null || { echo "site: mkdocs is not here: apt-get install mkdocs" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir "$work/docs"
cp "$root"/docs/*.md "$root/docs/references.bib" "$work/docs/"
find "$root/docs" -mindepth 1 -maxdepth 1 -type d -exec cp -r {} "$work/docs/" \;   # of pictures
# links out of docs/ lead to files of the repository, which a site has not: they become text; those from the root lead into docs/
sed -E 's#\]\(docs/#](#g' "$root/README.md" >"$work/docs/index.md"
sed -E 's#\]\(docs/#](#g' "$root/CHANGELOG.md" >"$work/docs/changelog.md"
sed -E 's#\]\(docs/#](#g' "$root/CONTRIBUTING.md" >"$work/docs/contributing.md"
[ ! -f "$root/SECURITY.md" ] || sed -E 's#\]\(docs/#](#g' "$root/SECURITY.md" >"$work/docs/security.md"
sed -E -i 's#\]\((\.\./)?CHANGELOG\.md#](changelog.md#g; s#\]\((\.\./)?CONTRIBUTING\.md#](contributing.md#g; s#\]\((\.\./)?SECURITY\.md#](security.md#g
    s#\[([^][]*)\]\((\.\./|LICENSE|examples/|scripts/|src/|data/|tests/|packaging/)[^)]*\)#\1#g' "$work"/docs/*.md

if compgen -G "$build/python/schuler/_schuler*.so" >/dev/null; then
    PYTHONPATH="$build/python" /usr/bin/python3 -B - >"$work/docs/python-api.md" <<'PYTHON' || rm "$work/docs/python-api.md"
import inspect
import schuler

def entry(name, thing, level="##"):
    try:
        call = str(inspect.signature(thing)) if callable(thing) else ""
    except (TypeError, ValueError):
        call = ""
    text = inspect.getdoc(thing) or ""
    first, _, rest = text.partition("\n")
    if first.startswith(thing.__name__ + "("):     # pybind11 puts the call first
        call, text = "", rest.strip()
    print(f"\n{level} {name}\n\n```text\n{name}{call if len(call) < 600 else '(...)'}\n\n{text}\n```")

print("# Python, every name\n\nMade of the docstrings of the package; introduced in [Python](python.md).")
for name in sorted(n for n in dir(schuler) if not n.startswith("_") and n != "analyze"):
    thing = getattr(schuler, name)
    entry(f"schuler.{name}", thing)
    if inspect.isclass(thing) and name in ("Navigator", "Mekf", "Result", "Table", "Recording"):
        for member in sorted(m for m in vars(thing) if not m.startswith("_")):
            value = vars(thing)[member]
            if callable(value) and inspect.getdoc(value):
                entry(f"{name}.{member}", value, "###")
for name in sorted(schuler.analyze.__all__):
    entry(f"schuler.analyze.{name}", getattr(schuler.analyze, name))
PYTHON
fi

if command -v doxygen >/dev/null; then
    (cd "$root" && { cat docs/Doxyfile; printf 'OUTPUT_DIRECTORY = "%s"\nHTML_OUTPUT = cpp\n' "$work/docs"; } | doxygen - >"$work/doxygen.log" 2>&1) ||
        { tail -n 5 "$work/doxygen.log" >&2; exit 1; }
    [ -f "$work/docs/cpp/index.html" ] || { echo "site: doxygen made no pages" >&2; exit 1; }
    printf '%s\n' '# C++, every name' '' 'Made by Doxygen of the comments in the headers: [classes](cpp/annotated.html), [namespaces](cpp/namespaces.html),' \
        '[files](cpp/files.html). Introduced in [In real time](embed.md) and [Building and installing](building.md).' >"$work/docs/cpp-api.md"
fi

page() { [ ! -f "$work/docs/$1" ] || printf '      - "%s": %s\n' "$2" "$1"; }
{
    printf 'site_name: Schuler\nsite_dir: "%s"\ndocs_dir: "%s"\nuse_directory_urls: false\nplugins: [search]\n' "$out" "$work/docs"
    printf 'theme: {name: mkdocs, highlightjs: false}\nmarkdown_extensions: [tables, toc, fenced_code]\nnav:\n  - Home: index.md\n'
    echo '  - Use:'
    for p in "own-data.md:Your own data" "cookbook.md:Cookbook" "faq.md:Questions" "building.md:Building and installing" "options.md:Options" "files.md:Files" "outputs.md:Outputs" "verdict.md:Verdict" \
        "found.md:What is found" "sensors.md:Sensors" "faults.md:Faults" "ui.md:In the browser" "python.md:Python" "python-api.md:Python, every name" \
        "octave.md:Octave and MATLAB" "cpp-api.md:C++, every name" "embed.md:In real time" "live.md:Live"; do
        page "${p%%:*}" "${p#*:}"
    done
    echo '  - Subjects:'
    for p in "ahrs.md:Attitude and heading" "complex.md:Integrated system" "gravimetry.md:Gravimetry" "ppk.md:Carrier phase" "receiver.md:Receiver" "triad.md:Ranges" "papers.md:Papers" "campaigns.md:Campaigns"; do
        page "${p%%:*}" "${p#*:}"
    done
    echo '  - Background:'
    for p in "theory.md:Theory" "math.md:Formulas" "estimation.md:Estimation" "conventions.md:Conventions" "results.md:Results" "comparison.md:Beside other programs" "speed.md:Speed" "glossary.md:Glossary" \
        "architecture.md:Architecture" "trust.md:Trust" "security.md:Security" "contributing.md:Contributing" "changelog.md:Changelog"; do
        page "${p%%:*}" "${p#*:}"
    done
} >"$work/mkdocs.yml"
listed=$(grep -oE '[a-z-]+\.md$' "$work/mkdocs.yml" | sort)
for file in "$work"/docs/*.md; do
    grep -qx "$(basename "$file")" <<<"$listed" || { echo "site: $(basename "$file") is in no part of the menu (scripts/site.sh)" >&2; exit 1; }
done
mkdocs build --quiet --strict --clean --config-file "$work/mkdocs.yml"
# mkdocs sees that a page is there, not that it has the section a link names.
/usr/bin/python3 -B - "$out" <<'PYTHON'
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.ids, self.links = set(), set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids.add(values.get("id"))
        if tag == "a" and values.get("href"):
            self.links.add(values["href"])


pages = {path.resolve(): Page(path) for path in Path(sys.argv[1]).rglob("*.html")}
broken = 0
for path, page in pages.items():
    if "cpp" in path.relative_to(Path(sys.argv[1]).resolve()).parts:
        continue     # Doxygen's own
    for link in sorted(page.links):
        place, section = urldefrag(link)
        there = pages.get((path.parent / unquote(place)).resolve() if place else path)
        if section and there is not None and unquote(section) not in there.ids:
            print(f"site: {path.name}: {link}: no such section", file=sys.stderr)
            broken += 1
sys.exit(broken > 0)
PYTHON
! grep -rlE '<(script|link)[^>]*(src|href)="https?://' "$out" --include='*.html' | head -3 | grep . || { echo "site: pages load from the network" >&2; exit 1; }
echo "site: $(find "$out" -name '*.html' | wc -l) pages in $out"
