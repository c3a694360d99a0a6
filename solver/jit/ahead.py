"""Kernels that a run needs later are compiled by other processes while it compiles those that it needs first.

``python -m solver.jit.ahead`` is such a process: it reads which kernels from its standard input, and leaves them where
kernels are kept.
"""

from __future__ import annotations

import importlib
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from solver.jit.cache import Kernel

Job = tuple[Kernel, tuple[Any, ...]]
"""A kernel, and arguments of the types that it will be called with."""


def compile_ahead(jobs: Sequence[Job], processes: int) -> None:
    """Have kernels that are not on the disk yet compiled by other processes.

    Who calls such a kernel waits until it is there, and compiles it where the other process failed.
    """
    if processes < 1:
        return
    signatures = {(kernel, tuple(map(kernel.typeof_pyval, values))): None for kernel, values in jobs}
    missing = [(kernel, signature) for kernel, signature in signatures if not kernel.is_stored(signature)]
    for first in range(min(processes, len(missing))):
        with suppress(OSError):  # no process is to be had
            _start(missing[first::processes])


def _start(missing: Sequence[tuple[Kernel, Any]]) -> None:
    names = [(kernel.__module__, kernel.__name__, signature) for kernel, signature in missing]
    root = str(Path(__file__).resolve().parents[2])
    paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
    process = subprocess.Popen(
        [sys.executable, "-m", "solver.jit.ahead"],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
    )
    assert process.stdin is not None
    with process.stdin as pipe:
        pipe.write(pickle.dumps(names))
    threading.Thread(target=process.wait, daemon=True).start()  # nobody else may ask how it ended
    for kernel, signature in missing:
        kernel.is_compiled_by(process, signature)


def _compile(names: Sequence[tuple[str, str, Any]]) -> None:
    for module, name, signature in names:
        getattr(importlib.import_module(module), name).compile(signature)


if __name__ == "__main__":
    _compile(pickle.loads(sys.stdin.buffer.read()))
