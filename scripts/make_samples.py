"""Make the volumes in data/samples from the packages they come from; needed only to repeat it.

The packages, in one folder:

    pip download nilearn==0.14.1 --no-deps
    pip download pyradiomics==3.0.1 --no-deps --no-binary :all:
    apt-get download mricron-data=1.2.20211006+dfsg-4

Then: python scripts/make_samples.py FOLDER
"""

from __future__ import annotations

import argparse
import gzip
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

import numpy as np

from volviz.io import load

DATA = Path(__file__).resolve().parent.parent / "data"
BRAIN = "nilearn/datasets/data/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz"
CHEST = "pyradiomics-3.0.1/data/lung2_image.nrrd"
HEAD = "usr/share/mricron/templates/ch2.nii.gz"

#: Values above this are taken for the body when the chest is cropped, in Hounsfield units.
BODY = -300
MARGIN = 6


def one(folder: Path, pattern: str) -> Path:
    """The file in a folder that fits a pattern."""
    found = sorted(folder.glob(pattern))
    if not found:
        sys.exit(f"{pattern} is not in {folder}; see the head of {Path(__file__).name}")
    return found[-1]


def make_brain(folder: Path) -> None:
    """Copied as it is."""
    with zipfile.ZipFile(one(folder, "nilearn-*.whl")) as wheel:
        (DATA / "samples" / "mri-brain.nii.gz").write_bytes(wheel.read(BRAIN))


def make_head(folder: Path, scratch: Path) -> None:
    """Copied as it is."""
    package = one(folder, "mricron-data_*.deb")
    subprocess.run(["dpkg-deb", "-x", str(package), str(scratch)], check=True)
    (DATA / "samples" / "mri-head.nii.gz").write_bytes((scratch / HEAD).read_bytes())


def make_chest(folder: Path, scratch: Path) -> None:
    """Cropped to the body, the mean of each 2 x 2 pixels of a slice, in steps of 4 HU; geometry moved."""
    with tarfile.open(one(folder, "pyradiomics-*.tar.gz")) as archive:
        member = archive.extractfile(CHEST)
        assert member is not None
        source = scratch / "lung2.nrrd"
        source.write_bytes(member.read())
    volume = load(source)
    body = volume.array.max(axis=0) > BODY
    rows, columns = np.flatnonzero(body.any(axis=1)), np.flatnonzero(body.any(axis=0))
    y0, y1 = max(rows[0] - MARGIN, 0) & ~1, min(rows[-1] + MARGIN, body.shape[0]) & ~1
    x0, x1 = max(columns[0] - MARGIN, 0) & ~1, min(columns[-1] + MARGIN, body.shape[1]) & ~1
    part = volume.array[:, y0:y1, x0:x1].astype(np.int32)
    fours = part[:, ::2, ::2] + part[:, 1::2, ::2] + part[:, ::2, 1::2] + part[:, 1::2, 1::2]
    # the noise is some 15 HU: steps of 4 HU cost nothing but take a quarter off the file
    halved = (np.floor_divide(fours + 8, 16) * 4).astype("<i2")
    sx, sy, sz = volume.spacing
    # the middle of four pixels lies half a pixel beyond the first of them
    ox, oy, oz = (volume.index_to_world @ (x0 + 0.5, y0 + 0.5, 0.0, 1.0))[:3]
    header = (
        "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\n"
        f"sizes: {halved.shape[2]} {halved.shape[1]} {halved.shape[0]}\n"
        f"space directions: ({2 * sx!r},0,0) (0,{2 * sy!r},0) (0,0,{sz!r})\n"
        "kinds: domain domain domain\nendian: little\nencoding: gzip\n"
        f"space origin: ({float(ox)!r},{float(oy)!r},{float(oz)!r})\n"
        'space units: "mm" "mm" "mm"\nsample units: "HU"\n\n'
    )
    packed = gzip.compress(halved.tobytes(), compresslevel=9, mtime=0)
    (DATA / "samples" / "ct-chest.nrrd").write_bytes(header.encode() + packed)


def main() -> None:
    """Make all three."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where the downloaded packages lie")
    folder = parser.parse_args().folder
    (DATA / "samples").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        make_brain(folder)
        make_head(folder, Path(scratch))
        make_chest(folder, Path(scratch))


if __name__ == "__main__":
    main()
