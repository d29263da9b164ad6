"""The rules of the house can fail: each finds what is wrong in a small tree made for it, and nothing in the same tree put right.

    selftest.py CXX
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import lint

GOOD = {
    "CMakeLists.txt": "schuler_room(core DEPENDS Eigen3::Eigen)\nschuler_room(math DEPENDS schuler_core PRIVATE x)\n",
    "README.md": "See docs/conventions.md.\n",
    "docs/architecture.md": "| level | room | does | may include | only here |\n|---|---|---|---|---|\n"
                            "| 0 | core | words | - | spdlog |\n| 1 | math | numbers | core | kissfft |\n| - | cli | prints | core | CLI11 |\n",
    "docs/conventions.md": "| `n` | local level |\n| `b` | body |\n",
    "docs/references.bib": "@book{Groves2013, title = {x}}\n",
    "src/schuler/core/a.h": "#include <Eigen/Core>\n// [Groves2013:5.1], conventions.md. printf( in a comment, std::cout too.\nint a();\n",
    "src/schuler/math/b.h": "#include \"schuler/core/a.h\"\nErrorDynamics error_b(int x);\nErrorDynamics error_by_name(int x);\nMatrix3d C_nb; int q_part; int C_nb_est; int C_new_old;\n",
    "src/schuler/math/b.cpp": "#include <kissfft.hh>\nconst char* text = \"exit(1) // C_xy\"; int i = thread.exit() + on_exit(1);\n",
    "src/schuler/math/detail/c.h": "#pragma once\n",
    "src/schuler/math/text.cpp": "auto s = fmt::format(\"{} of {:.1f} \"\n    \"were left\", n, m);\n",
    ".clang-format": "DisableFormat: true\n",
    "cli/main.cpp": "#include \"schuler/core/a.h\"\n#include <CLI/CLI.hpp>\n#include <cstdio>\nint main() { std::printf(\"x\"); }\n",
    "tests/house/jacobians.txt": "# comment\nresult ErrorDynamics\nfunction a\nexcept error_by_name\nexcept dynamics\n",
    "src/schuler/math/filter.cpp": "void f() { estim::propagate<16>(P); }\n",
    "src/schuler/math/frame.h": "struct LevelFrame {\n    static ErrorDynamics dynamics(int x);\n};\n",
    "tests/house/filters.txt": "# comment\nsrc/schuler/math/filter.cpp LevelFrame\n",
    "tests/math/filters_test.cpp": "SCHULER_ERROR_MODEL(A, \"math.LevelFrame.error_b.error_by_name\", LevelFrame)\n",
    "tests/math/b_test.cpp": "#include \"support/perturbation.h\"\nSCHULER_JACOBIAN(error_b, \"math.error_b\") {}\nSCHULER_JACOBIAN(other, \"a.at_rest\") {}\n",
    "ui/src/messages/en.json": '{"a.b": "in {n} runs", "c": "c", "e": "{n, plural, one {{n} run} other {{n} runs of {m}}}", "reason.d": "{n} of {m} were left"}',
    "ui/src/messages/uk.json": '{"a.b": "у {n} прогонах", "c": "ц", "e": "{n, plural, one {прогін} few {прогони {m}} many {прогонів} other {прогону}}", "label.x": "довідка", "reason.d": "лишилося {n} з {m}"}',
    "ui/src/messages/help.uk.json": '{"a sentence": "речення"}',
    "ui/src/messages/help.ru.json": '{"a sentence": "предложение"}',
    "ui/src/main.ts": 'h("p", null, t("a.b", { n: 1 }), t(`tab.${name}`));\n',
}

# Rule, file, what is put in place of what ("" appends), part of the finding that must come.
BAD = [
    ("rooms", "src/schuler/core/a.h", "", '#include "schuler/math/b.h"\n', "core may not include math"),
    ("rooms", "cli/main.cpp", "", '#include "schuler/math/b.h"\n', "cli may not include math"),
    ("rooms", "src/schuler/math/b.h", '"schuler/core/a.h"', '"a.h"', "include as"),
    ("rooms", "src/schuler/math/b.h", "core/a.h", "core/detail/a.h", "private header of core"),
    ("rooms", "src/schuler/attic/d.h", "", "#pragma once\n", "attic is not in the table"),
    ("rooms", "docs/architecture.md", "| words | - |", "| words | math |", "not a room of a lower level"),
    ("rooms", "CMakeLists.txt", "core DEPENDS Eigen3::Eigen", "core DEPENDS schuler_math", "core links math"),
    ("third_party", "src/schuler/core/a.h", "", "#include <kissfft.hh>\n", "kissfft does not belong in core"),
    ("third_party", "src/schuler/math/b.h", "", "#include <kissfft.hh>\n", "kissfft in a public header"),
    ("third_party", "src/schuler/core/a.h", "", "#include <boost/any.hpp>\n", "unknown third-party"),
    ("third_party", "src/schuler/core/a.h", "", "  #  include <CLI/CLI.hpp>\n", "CLI11 does not belong in core"),
    *[("silence", "src/schuler/math/b.cpp", "", text + "\n", "the library does not")
      for text in ("std::cout << 1;", "std::cerr << 1;", "printf(\"x\");", "std::fprintf(f, \"x\");", "exit(1);", "std::exit(1);",
                   "std::abort();", "assert(x > 0);", "#include <iostream>", "fmt::print(\"x\");", "/* a */ std::terminate();")],
    ("citations", "src/schuler/core/a.h", "", "int b();  // [Savage1998a:12]\n", "[Savage1998a] is not in"),
    ("citations", "docs/conventions.md", "", "after [PaperA:4.2.1]\n", "[PaperA] is not in"),
    ("citations", "docs/references.bib", "", "@book{Groves2013, title = {y}}\n", "stands here twice"),
    ("documents", "src/schuler/core/a.h", "", "// nowhere.md 5.2\n", "there is no nowhere.md"),
    ("documents", "README.md", "", "[x](docs/gone.md)\n", "there is no docs/gone.md"),
    ("frames", "src/schuler/math/b.h", "", "Matrix3d C_xn;\n", "C_xn: two of the frames"),
    ("frames", "src/schuler/math/b.h", "", "Quaterniond q_nav = C_nb;\n", "q_nav: two of the frames"),
    ("frames", "src/schuler/math/b.h", "", "Matrix3d C_n_b;\n", "C_n_b: two of the frames"),
    ("length", "src/schuler/core/a.h", "", "\n" * lint.MAX_LINES, "longer than"),
    ("layout", ".clang-format", "DisableFormat: true", "BasedOnStyle: Google", "another layout"),
    ("jacobians", "src/schuler/math/b.h", "", "ErrorDynamics error_c(int x);\n", "error_c is not registered"),
    ("jacobians", "tests/math/b_test.cpp", "math.error_b", "math.b", "error_b is not registered"),
    ("jacobians", "tests/math/b_test.cpp", "SCHULER_JACOBIAN(other", "// SCHULER_JACOBIAN(other", "a is not registered"),
    ("jacobians", "tests/house/jacobians.txt", "", "function gone\n", "gone is not in src"),
    ("error_models", "src/schuler/math/b.h", "", "ErrorDynamics error_c(int x);\n", "error_c is not registered"),
    ("error_models", "tests/math/filters_test.cpp", "LevelFrame.", "", "LevelFrame is not registered"),
    ("error_models", "tests/math/filters_test.cpp", "SCHULER", "// SCHULER", "error_b is not registered"),
    ("error_models", "src/schuler/math/b.cpp", "", "estim::propagate<24>(P);\n", "math/b.cpp:1: propagates a covariance"),
    ("error_models", "tests/house/filters.txt", "LevelFrame", "LevelFrame OtherFrame", "OtherFrame is not registered"),
    ("error_models", "tests/house/filters.txt", "", "src/gone.cpp A\n", "there is no src/gone.cpp"),
    ("messages", "ui/src/messages/uk.json", '"c"', '"option.c"', "c is missing"),
    ("messages", "ui/src/messages/uk.json", '"label.x"', '"d"', "d is not in en.json"),
    ("messages", "ui/src/messages/uk.json", '"ц"', '" "', "c is empty"),
    ("messages", "ui/src/messages/uk.json", "у {n}", "у {m}", "a.b has other names in braces"),
    ("messages", "ui/src/messages/uk.json", " many {прогонів}", "", "e has no form many"),
    ("messages", "ui/src/messages/uk.json", "{прогони {m}}", "{прогони}", "e has other names in braces"),
    ("messages", "ui/src/messages/uk.json", "other {прогону}}", "other {прогону}", "e has an open brace"),
    ("messages", "ui/src/messages/uk.json", "у {n}", "у '{n}'", "a.b has a quoted brace"),
    ("messages", "ui/src/messages/help.uk.json", "a sentence", "another", "a sentence is missing"),
    ("messages", "ui/src/messages/help.ru.json", "предложение", "", "a sentence is empty"),
    ("messages", "src/schuler/math/text.cpp", "left", "kept", "reason.d is no sentence of the program"),
    ("messages", "ui/src/main.ts", '"a.b"', '"a.c"', "a.c is in no message file"),
]


def write(root, tree):
    for name, text in tree.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


failures = []
for name, rule in lint.RULES.items():
    if name not in {bad[0] for bad in BAD}:
        failures.append(f"{name}: no example that makes it fail")
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder), GOOD)
        failures += [f"{name} finds something where nothing is wrong: {text}" for text in rule(Path(folder))]
for name, file, old, new, expected in BAD:
    with tempfile.TemporaryDirectory() as folder:
        text = GOOD.get(file, "")
        assert old in text, (file, old)
        write(Path(folder), {**GOOD, file: text.replace(old, new) if old else text + new})
        found = lint.RULES[name](Path(folder))
        if not any(expected in text for text in found):
            failures.append(f"{name} does not find {expected!r} in {file}: {found}")
for text, status in (("inline std::string a();", 1), ("#include <string>\ninline std::string a();", 0)):
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder), {"src/schuler/core/a.h": f"#pragma once\n{text}\n"})
        done = subprocess.run([sys.executable, Path(__file__).with_name("headers.py"), "--source", folder, "--work", f"{folder}/work", "--",
                               sys.argv[1]], capture_output=True)
        if done.returncode != status:
            failures.append(f"headers.py on {text!r}: exit status {done.returncode}")
print("\n".join(failures) or f"{len(BAD)} wrong trees found out, none of the right ones")
sys.exit(1 if failures else 0)
