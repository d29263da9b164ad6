"""What a command has done: text, numbers, files."""
import json
import shutil
import tempfile
import warnings
import weakref
from pathlib import Path

from . import _schuler
from ._error import Error
from ._tables import csv_table, h5_table, h5_tables


class NotTrustworthy(UserWarning):
    """The program's own verdict on a solution: do not use it."""


class Result:
    """Result of a command. Its tables are read when they are asked for, once.

    command   "process", ...
    text      the tables that the program prints
    summary   the fields of summary.json, or of the command's JSON document, as a dict
    warnings  list of texts
    verdict   whether the solution may be trusted: one line, or an empty text
    usable    False where the verdict is not to use it
    folder    where the files are: pathlib.Path, or None. Without `output` it is a temporary folder that goes with the last reference.
    files     their paths
    notice    the dataset.toml that was inferred, or an empty text

    `result["solution"]` or `result.solution` is a schuler.Table; `result.tables` are the names of all.
    """

    def __init__(self, command, outcome, temporary=None):
        self.command = command
        self.text = outcome.text
        self.summary = json.loads(outcome.json) if outcome.json else {}
        self.warnings = list(outcome.warnings)
        self.verdict = outcome.verdict
        self.usable = outcome.usable
        self.notice = outcome.notice
        self.files = [Path(f) for f in outcome.files]
        self.folder = Path(outcome.folder) if str(outcome.folder) not in ("", ".") else temporary
        self._read = {}
        if temporary is not None:
            weakref.finalize(self, shutil.rmtree, temporary, ignore_errors=True)
        if not self.usable:
            warnings.warn(self.verdict, NotTrustworthy, stacklevel=4)

    def _sources(self):
        """name -> function that reads the table."""
        found = {}
        if self.folder is None or not self.folder.is_dir():
            return found
        for path in sorted(self.folder.glob("*.csv")):
            found[path.stem] = lambda path=path: csv_table(path)
        run = self.folder / "run.h5"
        if run.is_file():
            for name in h5_tables(run):
                found[name] = lambda name=name: h5_table(run, name)
        return found

    @property
    def tables(self):
        """Names of the tables."""
        return sorted(self._sources())

    def __getitem__(self, name):
        if name not in self._read:
            sources = self._sources()
            if name not in sources:
                near = _schuler.nearest_key(str(name), list(sources))
                raise Error.of(f"there is no table {name!r}", self.command,
                               f"did you mean {near}?" if near else f"there are {', '.join(sorted(sources)) or 'none'}")
            self._read[name] = sources[name]()
        return self._read[name]

    def __contains__(self, name):
        return name in self._sources()

    def __getattr__(self, name):
        if name.startswith("_") or name not in self._sources():
            raise AttributeError(f"this result of {self.__dict__.get('command')!r} has no {name!r}")
        return self[name]

    def __dir__(self):
        return [*super().__dir__(), *self.tables]

    def __repr__(self):
        head = f"<schuler.Result of {self.command}" + (f" in {self.folder}" if self.folder else "") + ">"
        return "\n".join(part for part in (head, self.text.rstrip(), self.verdict) if part)


def temporary_folder():
    return Path(tempfile.mkdtemp(prefix="schuler-"))
