"""DICOM: a folder of slices, a DICOMDIR, one file of such a folder, or one file of many frames.

`finding` looks for files, `headers` makes of every file its frames, `grouping` sorts them into volumes, `lattice`
says where they lie, `pixels` decodes them, `reading` puts them together; `segmentation` does so for label maps,
`structures` for outlines.
Positions and directions are LPS in millimetres already (DICOM PS3.3, C.7.6.2.1.1).
"""

from volviz.io.dicom.finding import sniff as sniff
from volviz.io.dicom.reading import open_source as open_source
