"""The notebooks of the papers run, and draw."""
import importlib.util
import shutil
import sys
import unittest

from support import FOLDER, SOURCE, main


MISSING = [name for name in ("nbclient", "nbformat", "ipykernel", "matplotlib") if not importlib.util.find_spec(name)]


class Notebooks(unittest.TestCase):
    def test_papers(self):
        import nbclient
        import nbformat

        notebooks = sorted((SOURCE / "examples/notebooks").glob("paper_*.ipynb"))
        self.assertEqual([p.stem for p in notebooks], [f"paper_{letter}" for letter in "abcde"])
        shutil.copytree(SOURCE / "examples", FOLDER / "examples", dirs_exist_ok=True)
        for path in notebooks:
            with self.subTest(path.name):
                notebook = nbformat.read(path, as_version=4)
                self.assertFalse(any(cell.get("outputs") for cell in notebook.cells), "kept without outputs")
                client = nbclient.NotebookClient(notebook, timeout=200, kernel_name="python3", resources={"metadata": {"path": str(FOLDER / "examples/notebooks")}})
                client.execute()   # an exception of a cell is one of this
                outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
                drawn = [o for o in outputs if o.output_type == "display_data" and len(o.data.get("image/png", "")) > 5000]
                self.assertGreaterEqual(len(drawn), 2)
                self.assertFalse([o for o in outputs if o.output_type == "stream" and o.name == "stderr" and "Warning" in o.text])


if __name__ == "__main__":
    if MISSING:   # a test that does nothing is no test that passes
        print(f"skipped: python3-{', python3-'.join(MISSING)} is not installed")
        sys.exit(77)
    main()
