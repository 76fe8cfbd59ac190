"""The bundled samples: real volumes from `data/`, and generated ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from volviz.data_files import data_file
from volviz.errors import InputError
from volviz.io import generate
from volviz.io.axes import to_zyx
from volviz.io.file_source import FileSource, file_source
from volviz.io.geometry import Geometry
from volviz.volume_data.references import SAMPLE_PREFIX

if TYPE_CHECKING:
    from volviz.io.reader import LoadRequest
    from volviz.volume_data.source import VolumeSource
    from volviz.volume_data.volume import Volume

_MNI = "MNI licence: free use and redistribution with its notice"


@dataclass(frozen=True)
class Sample:
    """A volume that comes with VolViz.

    Attributes
    ----------
    id : str
        ``volviz.load("sample:<id>")``.
    label, description : str
        For menus and lists.
    licence, source : str
        Terms in a few words, and where the volume comes from; in full in ``data/README.md``.
    modality : str
        "MRI", "CT", "industrial CT", "analytic".
    preset : str or None
        Transfer-function preset that shows it well; None = the automatic one.
    file : str or None
        Below ``data/``; None for generated volumes.
    """

    id: str
    label: str
    description: str
    licence: str
    source: str
    modality: str
    preset: str | None = None
    file: str | None = None


#: The first one is shown at the first start.
_SAMPLES = (
    Sample(
        "mri-brain",
        "MRI brain",
        "T1 MRI of the brain, mean of 152 persons (ICBM 152, 2009a symmetric), 197 x 233 x 189, 1 mm.",
        _MNI,
        "McConnell Brain Imaging Centre, by way of the Python package nilearn 0.14.1",
        "MRI",
        "mri-cortex",
        "samples/mri-brain.nii.gz",
    ),
    Sample(
        "mri-head",
        "MRI head",
        "T1 MRI of a head, mean of 27 scans of one person (Colin 27), 181 x 217 x 181, 1 mm.",
        _MNI,
        "McConnell Brain Imaging Centre, by way of the Debian package mricron-data 1.2.20211006",
        "MRI",
        "mri-skin",
        "samples/mri-head.nii.gz",
    ),
    Sample(
        "ct-chest",
        "CT chest",
        "CT of a chest in Hounsfield units, halved within the slices; slices 5 mm apart.",
        "BSD-3-Clause",
        "test image lung2 of the Python package pyradiomics 3.0.1",
        "CT",
        "ct-bone",
        "samples/ct-chest.nrrd",
    ),
    Sample(
        "engine",
        "Engine block",
        "Computed: an engine block of two metals with the noise of a scan, 256^3.",
        "MIT",
        "made by VolViz",
        "industrial CT",
        "engine",
    ),
    Sample(
        "marschner-lobb",
        "Marschner-Lobb signal",
        "Computed: ripples just below the sampling limit, the classic test of interpolation, 41^3.",
        "MIT",
        "made by VolViz after Marschner and Lobb 1994",
        "analytic",
    ),
    Sample(
        "sphere",
        "Sphere",
        "Computed: distance field of a sphere, isovalue 0 is its surface, 64^3.",
        "MIT",
        "made by VolViz",
        "analytic",
    ),
    Sample(
        "torus",
        "Torus",
        "Computed: distance field of a torus, isovalue 0 is its surface, 64^3.",
        "MIT",
        "made by VolViz",
        "analytic",
    ),
    Sample(
        "cube",
        "Homogeneous cube",
        "Computed: value 1 in a cube, 0 around it, 64^3.",
        "MIT",
        "made by VolViz",
        "analytic",
    ),
)

_GENERATED: dict[str, Callable[[Callable[[float, str], None]], Volume]] = {
    "engine": lambda report: generate.engine_block(report=report),
    "marschner-lobb": lambda _report: generate.marschner_lobb(),
    "sphere": lambda _report: generate.sphere(),
    "torus": lambda _report: generate.torus(),
    "cube": lambda _report: generate.cube(),
}


def samples() -> tuple[Sample, ...]:
    """All samples, the one for the first start first."""
    return _SAMPLES


def default_sample() -> Sample:
    """The sample that is shown when no file is given."""
    return _SAMPLES[0]


def sample_source(load: LoadRequest) -> VolumeSource:
    """Open a sample.

    Parameters
    ----------
    load : LoadRequest
        With the path ``sample:<id>``.

    Raises
    ------
    InputError
        There is no such sample.
    LoadError
        Its file is missing from the installation.
    """
    identifier = str(load.path).removeprefix(SAMPLE_PREFIX)
    found = next((s for s in _SAMPLES if s.id == identifier), None)
    if found is None:
        raise InputError(f"there is no sample {identifier!r}; there are {', '.join(s.id for s in _SAMPLES)}.")
    if load.hints.name is None:
        load = replace(load, hints=replace(load.hints, name=found.label))
    if found.file is None:
        made = _GENERATED[found.id](load.report)
        return file_source(
            load,
            lambda load: to_zyx(made.array, "ZYX", load),
            "ZYX",
            made.array.shape,
            Geometry.from_affine(made.index_to_world),
            format="generated",
            name=found.label,
        )
    from volviz.io.loading import open_file

    opened = open_file(replace(load, path=data_file(*found.file.split("/"))))
    said = opened.description
    unit = said.unit or ("HU" if found.modality == "CT" and load.hints.unit is None else "")
    described = replace(said, unit=unit, metadata={**said.metadata, "source": load.source})
    return FileSource(opened.load, described, opened.values)
