"""Type stubs of what is made of the option table: schuler/_made.pyi and schuler/analyze.pyi.

    PYTHONPATH=build/python python3 scripts/python_stubs.py [--check]      writes them beside the sources; --check compares
"""
import sys
from pathlib import Path

import schuler
from schuler import _commands as c

TYPES = {"number": "float", "integer": "int", "flag": "bool", "text": "str", "numbers": "Sequence[float]", "texts": "str | Sequence[str]"}
HEAD = '# Made by scripts/python_stubs.py of the option table; a test compares.\nfrom collections.abc import Callable, Sequence\nfrom os import PathLike\nfrom typing import Any\n\nfrom ._result import Result\n\n'


def type_of(option):
    if option["choices"] and option["shape"] == "text":
        if option["choices"] == ["on", "off"]:
            return "bool | str"
        return "str"
    if option["key"] == "outage" and option["shape"] == "texts":
        return "str | Sequence[str | tuple[float, float]]"
    if option["positional"] or option["key"] in ("output", "config"):
        return "str | PathLike[str]"
    return TYPES.get(option["shape"], "Any")


def stub_of(command, name):
    options = [o for o in command["options"] if o["key"] != "set"]
    parts = [f"{c.argument_of(o['key'])}: {type_of(o)}" for o in options if o["positional"]] + ["*"]
    parts += [f"{c.argument_of(o['key'])}: {type_of(o)} | None = ..." for o in options if not o["positional"]]
    if c.takes_settings(command):
        parts.append("settings: dict[str, Any] | None = ...")
    parts += ["progress: Callable[[float], object] | None = ...", "threads: int | None = ...", "force: bool | None = ..."]
    if c.takes_settings(command):
        parts.append("**keywords: Any")
    return f"def {name}(\n    " + ",\n    ".join(parts) + f",\n) -> Result: ...\n"


def stubs():
    whole, studies = HEAD, HEAD
    for name, command in c.COMMANDS.items():
        if name.startswith("analyze "):
            studies += stub_of(command, name.split(" ", 1)[1].replace("-", "_"))
        elif hasattr(schuler, name):   # a function of the package
            whole += stub_of(command, name.replace("-", "_"))
    return {"_made.pyi": whole, "analyze.pyi": studies}


if __name__ == "__main__":
    folder = Path(__file__).resolve().parent.parent / "python/schuler"
    different = [name for name, text in stubs().items() if not (folder / name).is_file() or (folder / name).read_text() != text]
    if "--check" in sys.argv:
        sys.exit(f"{', '.join(different)}: not what the option table says; run scripts/python_stubs.py" if different else 0)
    for name, text in stubs().items():
        (folder / name).write_text(text)
