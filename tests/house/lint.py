"""The rules of the house that reading the sources can check.

    lint.py RULE ROOT      prints `file:line: what is wrong`, one line a finding; exit status 1 when there are any

A rule is a function from the repository root to its findings; selftest.py shows for each that it can fail.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

CODE = (".h", ".cpp")
MAX_LINES = 500

# Third-party headers: pattern of the include, and the name that the table of docs/architecture.md gives the library.
LIBRARIES = [
    (r"Eigen/|unsupported/Eigen/", "Eigen"), (r"fmt/", "fmt"), (r"spdlog/", "spdlog"), (r"kiss_fft|kissfft", "kissfft"),
    (r"GeographicLib/", "GeographicLib"), (r"hdf5|H5", "HDF5"), (r"matio", "matio"), (r"sqlite3\.h", "SQLite"), (r"zstd\.h", "zstd"), (r"lz4frame\.h", "LZ4"), (r"bzlib\.h", "bzip2"), (r"yaml-cpp/", "yaml-cpp"), (r"zlib\.h", "zlib"),
    (r"fast_float/", "fast_float"), (r"toml\+\+/|toml\.hpp", "toml++"), (r"nlohmann/", "nlohmann-json"),
    (r"CLI/", "CLI11"), (r"boost/multiprecision/", "Boost.Multiprecision"),
    (r"boost/math/", "Boost.Math"), (r"mpi\.h", "MPI"), (r"httplib\.h", "cpp-httplib"), (r"linux/|malloc\.h", "Linux"),
    (r"(sys|netinet|arpa)/|(unistd|fcntl|poll|termios|signal|netdb)\.h", "POSIX"),
]
EVERYWHERE = {"Eigen", "fmt"}


def bare(text, strings=False):
    """Source text without comments (and without the contents of strings), line numbers kept."""
    pattern = r'//[^\n]*|/\*.*?\*/|R"(?P<d>[^(]*)\(.*?\)(?P=d)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\''

    def keep(match):
        found = match.group(0)
        if found.startswith("/"):
            return "\n" * found.count("\n")
        return found if strings else '""' + "\n" * found.count("\n")

    return re.sub(pattern, keep, text, flags=re.S)


def files(root, *folders, suffixes=CODE):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in suffixes and path.is_file():
                yield path


def lines(path, text=None):
    text = path.read_text(encoding="utf-8") if text is None else text
    return enumerate(text.split("\n"), start=1)


def finding(root, path, line, text):
    return f"{path.relative_to(root)}:{line}: {text}"


def room_table(root):
    """docs/architecture.md: room -> (level, rooms it may include, libraries only here). Rows start with a level or with -."""
    table = {}
    for _, line in lines(root / "docs/architecture.md"):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and len(cells) == 5 and re.fullmatch(r"\d+|-", cells[0]):
            words = [set(cell.replace("`", "").replace(",", " ").split()) - {"-"} for cell in cells[3:5]]
            level = int(cells[0]) if cells[0] != "-" else 99
            table[cells[1].strip("`")] = (level, *words)
    return table


def folder_of(root, room):
    inside = root / "src/schuler" / room
    return inside if inside.is_dir() else root / room


def rooms(root):
    """Rooms include only the rooms that the table allows, the table has no cycle, and CMakeLists.txt agrees with it."""
    table = room_table(root)
    found = []
    for room, (level, allowed, _) in table.items():
        for other in sorted(allowed):
            if other not in table or table[other][0] >= level:
                found.append(f"docs/architecture.md:1: {room} may include {other}, which is not a room of a lower level")
    for folder in sorted((root / "src/schuler").iterdir()):
        sources = list(files(root, folder.relative_to(root)))
        if folder.name not in table and sources:
            found.append(finding(root, sources[0], 1, f"room {folder.name} is not in the table of docs/architecture.md"))
    for room, (_, allowed, _) in table.items():
        for path in files(root, folder_of(root, room).relative_to(root)):
            for number, line in lines(path):
                match = re.match(r'\s*#\s*include\s*"([^"]+)"', line)
                if not match:
                    continue
                parts = match.group(1).split("/")
                if parts[0] != "schuler":
                    if folder_of(root, room).parent == root / "src/schuler":
                        found.append(finding(root, path, number, 'include as "schuler/ROOM/NAME.h"'))
                elif parts[1] != room and parts[1] not in allowed:
                    found.append(finding(root, path, number, f"{room} may not include {parts[1]}"))
                elif parts[1] != room and "detail" in parts:
                    found.append(finding(root, path, number, f"a private header of {parts[1]}"))
    recipe = re.sub(r"#[^\n]*", "", (root / "CMakeLists.txt").read_text())
    for match in re.finditer(r"schuler_room\((\w+)([^)]*)\)", recipe):
        for other in re.findall(r"schuler_(\w+)", match.group(2).split("PRIVATE")[0]):
            if match.group(1) not in table or other not in table[match.group(1)][1]:
                found.append(f"CMakeLists.txt:1: {match.group(1)} links {other}, which docs/architecture.md does not allow")
    return found


def third_party(root):
    """A third-party header appears only in the rooms that the table names for it."""
    table = room_table(root)
    found = []
    for room, (_, _, own) in table.items():
        for path in files(root, folder_of(root, room).relative_to(root)):
            for number, line in lines(path):
                match = re.match(r"\s*#\s*include\s*<([^>]+)>", line)
                if not match or re.fullmatch(r"[a-z0-9_]+|stdint\.h", match.group(1)):
                    continue
                name = next((name for pattern, name in LIBRARIES if re.match(pattern, match.group(1))), None)
                if name is None:
                    found.append(finding(root, path, number, f"unknown third-party header <{match.group(1)}>"))
                elif name not in EVERYWHERE | own:
                    found.append(finding(root, path, number, f"{name} does not belong in {room}"))
                elif path.suffix == ".h" and name not in EVERYWHERE and not {"detail", "inner"} & set(path.parts) and "src" in path.parts:
                    found.append(finding(root, path, number, f"{name} in a public header"))
    return found


SILENCE = re.compile(
    r"\bstd::(cout|cerr|clog)\b|\bfmt::print\b|#\s*include\s*<(iostream|cassert|assert\.h)>"
    r"|(?<![\w.>])(?:printf|fprintf|vprintf|puts|putchar|perror|assert|abort|exit|_Exit|quick_exit|terminate)\s*\(")


def silence(root):
    """The library never prints, exits, aborts or asserts."""
    found = []
    for path in files(root, "src/schuler"):
        for number, line in lines(path, bare(path.read_text(encoding="utf-8"))):
            match = SILENCE.search(line)
            if match:
                found.append(finding(root, path, number, f"the library does not {match.group(0).strip()}: throw schuler::Error"))
    return found


CITATION = re.compile(r"\[([A-Z][A-Za-z]*(?:\d{2,4}[a-z]?|[A-E]))(?::[^\]\n]*)?\]")


def citations(root):
    """[Key] and [Key:place] in sources, tests and documents resolve in docs/references.bib; no key is there twice."""
    keys = re.findall(r"^@\w+\{([^,\s]+),", (root / "docs/references.bib").read_text(encoding="utf-8"), flags=re.M)
    found = [f"docs/references.bib:1: {key} stands here twice" for key in sorted(set(keys)) if keys.count(key) > 1]
    for path in [*files(root, "src", "tests", "cli"), *files(root, "docs", suffixes=(".md",))]:
        for number, line in lines(path):
            comment = line if path.suffix == ".md" else line[line.find("//"):] if "//" in line else ""
            for key in CITATION.findall(comment):
                if key not in keys:
                    found.append(finding(root, path, number, f"[{key}] is not in docs/references.bib"))
    return found


def documents(root):
    """A document named in a source or in another document exists."""
    found = []
    named = re.compile(r"(?<![\w/.])((?:\w[\w-]*/)*[\w-]+\.md)\b")
    for path in [*files(root, "src", "tests", "cli"), *files(root, "docs", suffixes=(".md",)), root / "README.md"]:
        for number, line in lines(path):
            for name in named.findall(line):
                if not any((base / name).is_file() for base in (root, root / "docs", path.parent)):
                    found.append(finding(root, path, number, f"there is no {name}"))
    return found


def frame_letters(root):
    rows = re.findall(r"^\| `([a-z])` \|", (root / "docs/conventions.md").read_text(encoding="utf-8"), flags=re.M)
    return "".join(rows)


def frames(root):
    """C_xy and q_xy carry two frame letters of docs/conventions.md, first the frame that results; or two words (C_new_old), or a word."""
    letter = f"[{frame_letters(root)}]"
    found = []
    for path in files(root, "src", "cli"):
        for number, line in lines(path, bare(path.read_text(encoding="utf-8"))):
            for name, first, second in re.findall(r"\b([Cq]_([A-Za-z0-9]+)(?:_([A-Za-z0-9]+))?\w*)", line):
                words = len(first) > 3 or len(first) > 1 and len(second) > 1
                if not words and not re.fullmatch(f"{letter}{letter}[0-9]?", first):
                    found.append(finding(root, path, number, f"{name}: two of the frames {letter}, as in C_nb"))
    return found


def length(root):
    """A file is read in one sitting."""
    found = []
    for path in files(root, "src", "cli", "tests", "bench", "examples", "scripts", suffixes=(*CODE, ".py", ".sh")):
        count = path.read_text(encoding="utf-8").count("\n")
        if count > MAX_LINES:
            found.append(finding(root, path, count, f"longer than {MAX_LINES} lines: several subjects?"))
    return found


def layout(root):
    """C++ sources are laid out as .clang-format says; rows of matrices and tables stand between `clang-format off` and `on`."""
    sources = [str(path) for path in files(root, "src", "cli", "serve", "python", "tests", "bench", "examples")]
    done = subprocess.run(["clang-format-16", f"--style=file:{root / '.clang-format'}", "--dry-run", *sources],
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        return [f".clang-format:1: {done.stderr.strip()}"]
    found = {}
    for path, line in re.findall(r"^(\S+?):(\d+):\d+: warning: code should be clang-formatted", done.stderr, flags=re.M):
        found.setdefault(path, line)
    return [finding(root, Path(path), line, "another layout than clang-format-16 -i gives") for path, line in found.items()]


def jacobian_names(root):
    """Functions of tests/house/jacobians.txt: named there, or declared in a header with a result type named there."""
    names, types, exceptions = {}, [], set()
    for number, line in lines(root / "tests/house/jacobians.txt"):
        words = line.split("#")[0].split()
        if words[:1] == ["function"]:
            names[words[1]] = f"tests/house/jacobians.txt:{number}"
        elif words[:1] == ["result"]:
            types.append(re.escape(words[1]))
        elif words[:1] == ["except"]:
            exceptions.add(words[1])
    for path in files(root, "src/schuler", suffixes=(".h",)):
        text = bare(path.read_text(encoding="utf-8"))
        for match in re.finditer(rf"\b(?:{'|'.join(types) or '$^'})\s+(\w+)\s*\(", text):
            names.setdefault(match.group(1), f"{path.relative_to(root)}:{text.count(chr(10), 0, match.start()) + 1}")
    return {name: place for name, place in names.items() if name not in exceptions}


def jacobians(root):
    """Every analytic Jacobian is registered in the perturbation harness: SCHULER_JACOBIAN(ID, "ROOM.FUNCTION...")."""
    registered = set()
    for path in files(root, "tests"):
        for name in re.findall(r'\bSCHULER_JACOBIAN\(\s*\w+\s*,\s*"([^"]+)"', bare(path.read_text(encoding="utf-8"), strings=True)):
            registered.update(name.split("."))
    sources = "".join(bare(path.read_text(encoding="utf-8")) for path in files(root, "src"))
    found = []
    for name, place in sorted(jacobian_names(root).items()):
        if not re.search(rf"\b{name}\b", sources):
            found.append(f"{place}: {name} is not in src")
        elif name not in registered:
            found.append(f"{place}: {name} is not registered with SCHULER_JACOBIAN in any test")
    return found


def error_models(root):
    """Every filter's error dynamics stand before their oracles: SCHULER_ERROR_MODEL(ID, "ROOM.MODEL.FUNCTION...", TYPE)."""
    registered = set()
    for path in files(root, "tests"):
        for name in re.findall(r'\bSCHULER_ERROR_MODEL\(\s*\w+\s*,\s*"([^"]+)"', bare(path.read_text(encoding="utf-8"), strings=True)):
            registered.update(name.split("."))
    needed = {}
    for path in files(root, "src/schuler", suffixes=(".h",)):
        text = bare(path.read_text(encoding="utf-8"))
        for match in re.finditer(r"\bErrorDynamics\s+(\w+)\s*\(", text):
            policies = re.findall(r"\b(?:struct|class)\s+(\w+)[^;{]*\{", text[:match.start()]) if match.group(1) == "dynamics" else []
            name = policies[-1] if policies else match.group(1)
            needed.setdefault(name, f"{path.relative_to(root)}:{text.count(chr(10), 0, match.start()) + 1}")
    listed = {}
    for number, line in lines(root / "tests/house/filters.txt"):
        words = line.split("#")[0].split()
        if words:
            listed[words[0]] = number
            needed.update({model: f"tests/house/filters.txt:{number}" for model in words[1:] if model not in needed})
    found = []
    for path in files(root, "src/schuler"):
        name = path.relative_to(root).as_posix()
        if re.search(r"\bestim::propagate\b", bare(path.read_text(encoding="utf-8"))) and name not in listed:
            found.append(f"{name}:1: propagates a covariance and is not in tests/house/filters.txt")
    for name, number in listed.items():
        if not (root / name).is_file():
            found.append(f"tests/house/filters.txt:{number}: there is no {name}")
    for name, place in sorted(needed.items()):
        if name not in registered:
            found.append(f"{place}: {name} is not registered with SCHULER_ERROR_MODEL in any test")
    return found


def said_by(text, program):
    """A literal of the program, or two of them one after the other."""
    return text in program or any(text.startswith(part) and text[len(part):] in program for part in program if len(part) > 3)


PLURALS = {"en": {"one", "other"}, "uk": {"one", "few", "many", "other"}, "ru": {"one", "few", "many", "other"}}


def arguments_of(text, language):
    """The names that a message of ICU MessageFormat is filled with, and what is wrong with it."""
    names, open_, wrong, at = set(), [], [], 0
    while at < len(text):
        if text.startswith("''", at):
            at += 1
        elif text[at] == "'" and text[at + 1:at + 2] in ("{", "}"):
            wrong.append("has a quoted brace")
        elif text[at] == "{":
            if open_ and open_[-1] is not None:   # a form of a plural
                form = re.search(r"(=?\w+)\s*$", text[:at])
                open_[-1].add(form.group(1) if form else "")
                open_.append(None)
            else:
                head = re.match(r"{(\w+)(}|, plural,)", text[at:])
                if not head:
                    return names, wrong + [f"cannot be read at {text[at:at + 20]}"]
                names.add("{" + head.group(1) + "}")
                if head.group(2) == "}":
                    at += head.end() - 1
                else:
                    open_.append(set())
                    at += head.end() - 1
        elif text[at] == "}":
            forms = open_.pop() if open_ else wrong.append("has a brace too many")
            if forms is not None and PLURALS.get(language, forms) - forms:
                wrong.append(f"has no form {', '.join(sorted(PLURALS[language] - forms))}")
        at += 1
    return names, wrong + (["has an open brace"] if open_ else [])


def messages(root):
    """The page's texts: every language has those of en.json, none empty, with the same {names} and all plural forms of the language;
    those the page asks for are there.
    Another language may have more only for the option table (label., key.), whose English stands in the program."""
    def texts(path):
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}

    folder, found = root / "ui/src", []
    english = texts(folder / "messages/en.json")
    # sentences of the options, by their English; ui/tests/texts_test.mjs holds them to what the program sends
    helps = {path: texts(path) for path in sorted((folder / "messages").glob("help.*.json"))}
    for path, own in helps.items():
        found += [finding(root, path, 1, f"{key} is empty") for key, text in own.items() if not text.strip()]
        found += [finding(root, path, 1, f"{key} is missing") for key in sorted(set().union(*helps.values()) - own.keys())]
    for path in sorted(set((folder / "messages").glob("*.json")) - helps.keys()):
        own = texts(path)
        found += [finding(root, path, 1, f"{key} is missing") for key in english if key not in own]
        found += [finding(root, path, 1, f"{key} is not in en.json") for key in own
                  if key not in english and not key.startswith(("label.", "key."))]
        found += [finding(root, path, 1, f"{key} is empty") for key, text in own.items() if not text.strip()]
        for key, text in own.items():
            names, wrong = arguments_of(text, path.stem)
            found += [finding(root, path, 1, f"{key} {what}") for what in wrong]
            if names != arguments_of(english.get(key, text), "en")[0]:
                found.append(finding(root, path, 1, f"{key} has other names in braces than in en.json"))
    # sentences of the program are recognised by their English: it has to be what the program says
    braces = re.compile(r"{[^{}]*}")
    program = {braces.sub("{}", "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', literal))).replace('\\"', '"')
               for folder_of in ("src", "serve") for path in files(root, folder_of, suffixes=(".cpp", ".h"))
               for literal in re.findall(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*', path.read_text(encoding="utf-8"))}
    found += [finding(root, folder / "messages/en.json", 1, f"{key} is no sentence of the program") for key, text in english.items()
              if key.startswith("reason.") and not said_by(braces.sub("{}", text.replace("''", "'")), program)]
    for path in files(root, "ui/src", suffixes=(".ts",)):
        for number, line in lines(path):
            found += [finding(root, path, number, f"{key} is in no message file") for key in re.findall(r'\bt\("([\w.]+)"', line)
                      if key not in english]
    return found


RULES = {rule.__name__: rule for rule in (rooms, third_party, silence, citations, documents, frames, length, layout, jacobians,
                                        error_models, messages)}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in RULES:
        sys.exit(f"usage: lint.py {'|'.join(RULES)} ROOT")
    results = RULES[sys.argv[1]](Path(sys.argv[2]).resolve())
    print("\n".join(results) or "no findings")
    sys.exit(1 if results else 0)
