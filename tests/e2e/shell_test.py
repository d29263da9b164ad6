"""What the program tells a shell: help of every command, completion, the manual page."""
import re
import shutil
import subprocess
from pathlib import Path

from program_test import check, main


def listed(program, *command):
    """The commands that the help of a command lists."""
    text = program(*command, "--help").stdout
    part = text.split("Subcommands:\n")
    return re.findall(r"^  ([a-z]\S*)", part[1].split("\n\n")[0], re.M) if len(part) > 1 else []


def completed(program, script, words):
    """What bash would offer after `schuler WORDS`, the last of them unfinished."""
    quoted = " ".join(f"'{w}'" for w in ["schuler", *words])
    code = f"source {script}; COMP_WORDS=({quoted}); COMP_CWORD={len(words)}; _schuler; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    done = subprocess.run(["bash", "-c", code], cwd=program.folder, capture_output=True, text=True, timeout=20)
    check(done.returncode == 0 and not done.stderr, f"completion of {words}: {done.stderr}")
    return done.stdout.split()


def shell(program, _):
    folder = Path(program.folder)
    commands = [[name] for name in listed(program)]
    commands += [[*command, name] for command in commands for name in listed(program, *command)]
    check(["process"] in commands and ["analyze", "equator"] in commands, f"commands found: {commands}")
    for command in commands:
        check(program("help", *command).stdout == program(*command, "--help").stdout, f"help {' '.join(command)} is not its --help")
    check(program("help").stdout == program("--help").stdout, "help alone is --help")
    program.fails("help", "nothing", parts=["nothing"])
    program.fails("completion", "fish", parts=["fish"])

    script = folder / "schuler.bash"
    script.write_text(program("completion", "bash").stdout)
    check(subprocess.run(["bash", "-n", script], timeout=20).returncode == 0, "bash cannot read its completion")
    check(set(completed(program, script, [""])) == {c[0] for c in commands if len(c) == 1}, "commands are completed")
    check(completed(program, script, ["analyze", "eq"]) == ["equator"], "studies are completed")
    check(completed(program, script, ["process", "drive", "--smo"]) == ["--smooth"], "options are completed")
    check(completed(program, script, ["process", "--self-check", "o"]) == ["on", "off"], "words of an option are completed")
    check(completed(program, script, ["ahrs", "--filter", "m"]) == ["mekf"], "and no other command's")
    check(completed(program, script, ["process", ""]) == [], "elsewhere bash completes file names")

    (folder / "_schuler").write_text(program("completion", "zsh").stdout)
    if shutil.which("zsh"):
        done = subprocess.run(["zsh", "-n", folder / "_schuler"], capture_output=True, text=True, timeout=20)
        check(done.returncode == 0, f"zsh cannot read its completion: {done.stderr}")
    else:
        print("zsh is not here: its completion is not parsed")

    page = folder / "schuler.1"
    page.write_text(program("help", "--man").stdout)
    for command in commands:
        check(f".SS schuler {' '.join(command)}\n" in page.read_text(), f"{command} is not in the manual page")
    if shutil.which("groff"):
        done = subprocess.run(["groff", "-man", "-Tascii", "-ww", page], capture_output=True, text=True, timeout=20)
        check(done.returncode == 0 and not done.stderr, f"manual page: {done.stderr[:400]}")
        check("--self-check" in re.sub(r"\x1b\[\d+m|.\x08", "", done.stdout), "options are in the manual page")
    else:
        print("groff is not here: the manual page is not set")


if __name__ == "__main__":
    main({"shell": shell})
