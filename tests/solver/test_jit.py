"""Where compiled kernels are kept, whoever imports numba first."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
import os
os.environ.pop("NUMBA_CACHE_DIR", None)
import {first}
import {second}
import numba
from solver.particles import Particles
import solver.kernels.settle
print(numba.config.CACHE_DIR, solver.kernels.settle.settle.stats.cache_path)
"""


@pytest.mark.parametrize(("first", "second"), [("numba", "solver.jit"), ("solver.jit", "numba")])
def test_kernels_are_cached_by_the_state_of_the_sources_whoever_imports_numba_first(first, second):
    program = PROGRAM.format(first=first, second=second)
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    folder, kernel_folder = run.stdout.split()
    assert "ups-mpm" in folder
    assert kernel_folder.startswith(folder)
