"""Tags of ``<DataArchiver>`` for the PIDX format, which is not written."""

from __future__ import annotations

from typing import Annotated

from solver.declare import IntVector, Parameter, Section, one_of


class IndexedBlocks(Section):
    """Blocks of the indexed format."""

    partitionCount: Annotated[IntVector | None, Parameter("number of partitions in each direction")] = None
    idxBlockSize: Annotated[int, Parameter("samples in a block, as a power of two", ge=0)] = 15
    idxBlockCount: Annotated[int, Parameter("blocks in a file", ge=0)] = 256


class RawBlocks(Section):
    """Blocks of the raw format."""

    restructureBoxSize: Annotated[IntVector | None, Parameter("cells that one process writes")] = None
    pipeSize: Annotated[int, Parameter("variables that are written together", ge=0)] = 64


@one_of("idxIo", "rawIo")
class PidxOutput(Section):
    """How one kind of output is written."""

    compressionType: Annotated[
        str, Parameter("compression", choices=("None", "Chunking", "Chunking_Zfp"))
    ] = "None"
    compressionBitrate: Annotated[float, Parameter("bits kept of a number", gt=0.0)] = 32.0
    idxIo: Annotated[IndexedBlocks | None, Parameter("write the indexed format")] = None
    rawIo: Annotated[RawBlocks | None, Parameter("write the raw format")] = None


class Pidx(Section):
    """Output in the PIDX format."""

    debugOutput: Annotated[bool, Parameter("print what is written")] = False
    checkpoint: Annotated[PidxOutput | None, Parameter("how checkpoints are written")] = None
    visIO: Annotated[PidxOutput | None, Parameter("how output is written")] = None


class DataArchiverExtension(Section):
    """What the archiver may be told besides what this program does."""

    PIDX: Annotated[
        Pidx | None, Parameter("output in the PIDX format", ignored="archives are written in the UDA format")
    ] = None
