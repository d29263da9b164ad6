"""docs/cookbook.md: its commands run as printed, in the order of the page, and say what the page shows.

Fences of the page:
    ```sh       run by bash; the first command that fails ends it
    ```python   run by the interpreter of the package, where that is built (SCHULER_PYTHON_FOLDER)
    ```octave   run by octave-cli, where it is installed
    ```text     output of the fence before: each line stands in it, in this order. `...` stands for anything, a number for any number
    ```console  not run: it takes ports, a network or minutes
"""
import os
import re
import shutil
import subprocess
import time
from pathlib import Path

from program_test import check, main

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def recipes(page):
    """Title, text of each recipe."""
    parts = re.split(r"^## (.*)$", page, flags=re.M)
    return list(zip(parts[1::2], parts[2::2]))


def pattern(line):
    """What an output has to contain where the page prints this line: words as they are, numbers and blanks as they come."""
    pieces = []
    for piece in line.strip().split("..."):
        words = [re.escape(word) for word in NUMBER.split(piece)]
        pieces.append(re.sub(r"(?:\\ |\s)+", r"\\s+", NUMBER.pattern.join(words)))
    return re.compile(".*?".join(pieces))


def missing(shown, output):
    """The first line of `shown` that the output does not have behind the line before; None if it has all."""
    rest = output
    for line in filter(str.strip, shown.splitlines()):
        found = pattern(line).search(rest)
        if found is None:
            return line.strip()
        rest = rest[found.end():]
    return None


def interpreter(language, environment):
    if language == "sh":
        return ["bash", "-euo", "pipefail", "-c"]
    if language == "python" and environment.get("PYTHONPATH") and Path("/usr/bin/python3").exists():
        return ["/usr/bin/python3", "-B", "-c"]
    if language == "octave" and shutil.which("octave-cli"):
        return ["octave-cli", "--no-gui", "--quiet", "--eval"]
    return None


def cookbook(program, source):
    folder = Path(program.folder)
    (folder / "bin").mkdir()
    (folder / "bin/schuler").symlink_to(program.path)
    for name in ("examples", "octave"):
        (folder / name).symlink_to(source / name)
    environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}
    package = os.environ.get("SCHULER_PYTHON_FOLDER", "")
    environment.pop("PYTHONPATH", None)
    if package and any((Path(package) / "schuler").glob("*.so")):
        environment["PYTHONPATH"] = package
    page = (source / "docs/cookbook.md").read_text(encoding="utf-8")
    check(page.count("```") % 2 == 0 and len(recipes(page)) >= 20, f"{len(recipes(page))} recipes; all fences are closed")
    run = 0
    for title, text in recipes(page):
        check(re.search(r"\]\((?!#)[\w./-]+\.md", text), f"{title}: no page with the details")
        check(FENCE.search(text), f"{title}: no command")
        output = None
        for language, body in FENCE.findall(text):
            check(language in ("sh", "python", "octave", "text", "console"), f"{title}: ```{language} is none of this page's fences")
            if language == "text":
                line = None if output is None else missing(body, output)
                check(line is None, f"{title}: the output has no {line!r}:\n{output}")
                continue
            how = interpreter(language, environment)
            output = None
            if how is None:
                continue
            begun = time.monotonic()
            done = subprocess.run([*how, body], cwd=folder, env=environment, capture_output=True, text=True, timeout=200, stdin=subprocess.DEVNULL)
            check(done.returncode == 0, f"{title}: exit status {done.returncode} of\n{body}{done.stderr[-800:]}")
            output = done.stdout + done.stderr
            run += 1
            print(f"{time.monotonic() - begun:6.2f} s  {title}, {language}")
    check(run >= 20, f"{run} fences were run")


def cookbook_can_fail(program, source):
    """The comparison with the page tells words, order and shape of numbers."""
    output = "inside three sigma: 99.7 % of 962 fixes\nverdict   trustworthy: 7.2 m\n"
    for shown, right in (("inside three sigma: 12 % of 3 fixes", True), ("verdict ... 1 m", True), ("verdict trustworthy", True),
                         ("inside two sigma", False), ("verdict trustworthy\ninside three sigma", False), ("962 windows", False), ("of x fixes", False)):
        check((missing(shown, output) is None) == right, f"{shown!r} is {'' if right else 'not '}in the output")


if __name__ == "__main__":
    main({"cookbook": cookbook, "cookbook_can_fail": cookbook_can_fail})
