"""The stubs say what there is: those made of the option table are current, the others name the same things."""
import ast
import subprocess
import sys
import unittest

from support import SOURCE, main

import schuler
from schuler import _schuler


def names(path):
    tree = ast.parse((SOURCE / "python/schuler" / path).read_text())
    found = set()
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            found |= {alias.asname for alias in node.names if alias.asname}
    return found - {"np"}


class Stubs(unittest.TestCase):
    def test_made_ones_are_current(self):
        done = subprocess.run([sys.executable, SOURCE / "scripts/python_types.py", "--check"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_package(self):
        public = {name for name in dir(schuler) if not name.startswith("_")}
        self.assertEqual(names("__init__.pyi"), public)

    def test_compiled_part(self):
        for name in names("_schuler.pyi") - {"__getattr__"}:
            self.assertTrue(hasattr(_schuler, name), name)
            tree = ast.parse((SOURCE / "python/schuler/_schuler.pyi").read_text())
            for node in tree.body:
                if isinstance(node, ast.ClassDef) and node.name == name:
                    for member in node.body:
                        word = getattr(member, "name", None) or getattr(getattr(member, "target", None), "id", None) or member.targets[0].id
                        self.assertTrue(hasattr(getattr(_schuler, name), word), f"{name}.{word}")


if __name__ == "__main__":
    main()
