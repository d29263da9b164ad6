"""Makes the seeds of the fuzz targets of satellite files, containers, live streams and requests: synthetic, the same bytes each time.

    make_corpus.py FOLDER            writes FOLDER/{rinex,receiver_logs,containers,files,live,forms}/*
    make_corpus.py --check FOLDER    exit status 1 where a file differs, is missing or is none of them (ctest corpus.in_step)
"""
import sys
from pathlib import Path

import seeds_binary
import seeds_containers
import seeds_places
import seeds_text

FOLDERS = {"rinex": {name: text.encode() for name, text in seeds_text.seeds().items()}, "receiver_logs": seeds_binary.seeds(),
           "containers": seeds_containers.seeds(), **seeds_places.seeds()}
# written by libraries, whose versions differ in their bytes: kept as they are
KEPT = {"files": ["hdf5", "rosbag2"]}


def wrong(folder):
    """Names of files that are not what they should be."""
    for name, seeds in FOLDERS.items():
        present = {path.name: path.read_bytes() for path in (folder / name).iterdir() if path.name not in KEPT.get(name, [])}
        yield from (f"{name}/{seed}" for seed in sorted(present | seeds) if present.get(seed) != seeds.get(seed))


if __name__ == "__main__":
    checking = sys.argv[1:2] == ["--check"]
    root = Path(sys.argv[-1])
    if len(sys.argv) != (3 if checking else 2):
        sys.exit(__doc__)
    if checking:
        different = list(wrong(root))
        sys.exit(f"run tests/fuzz/make_corpus.py tests/fuzz/corpus, for these differ: {', '.join(different)}" if different else 0)
    for name, seeds in FOLDERS.items():
        (root / name).mkdir(parents=True, exist_ok=True)
        for seed, content in seeds.items():
            (root / name / seed).write_bytes(content)
