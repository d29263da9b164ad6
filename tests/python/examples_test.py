"""The examples of the papers run, and draw their figures where matplotlib is."""
import importlib.util
import subprocess
import sys
import unittest

from support import FOLDER, SOURCE, main


class Examples(unittest.TestCase):
    def test_papers(self):
        figures = FOLDER / "figures"
        for script in sorted((SOURCE / "examples/python").glob("paper_*.py")):
            with self.subTest(script.name):
                done = subprocess.run([sys.executable, "-B", script, figures], capture_output=True, text=True, timeout=200, cwd=FOLDER)
                self.assertEqual(done.returncode, 0, done.stderr)
                if importlib.util.find_spec("matplotlib"):
                    drawn = list(figures.glob(f"{script.stem}_*.png"))
                    self.assertTrue(drawn)
                    self.assertTrue(all(p.stat().st_size > 5000 for p in drawn))


if __name__ == "__main__":
    main()
