"""Where compiled kernels are kept, whoever imports numba first, and what is loaded to use them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import njit
from numba.core.codegen import JITCodeLibrary

from solver.dispatch import inline
from solver.jit import kernel
from solver.jit.calls import Calls

PROGRAM = """
import os
os.environ.pop("NUMBA_CACHE_DIR", None)
import {first}
import {second}
import numba
from solver.particles import Particles
from solver.kernels.settle import settle
settle.enable_caching()
print(numba.config.CACHE_DIR, settle.stats.cache_path)
"""


@pytest.mark.parametrize(("first", "second"), [("numba", "solver.jit"), ("solver.jit", "numba")])
def test_kernels_are_cached_by_the_state_of_the_sources_whoever_imports_numba_first(first, second):
    program = PROGRAM.format(first=first, second=second)
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    folder, kernel_folder = run.stdout.split()
    assert "ups-mpm" in folder
    assert kernel_folder.startswith(folder)


MODULE = """
from solver.jit import kernel

@kernel
def total(record, values):
    for i in range(len(values)):
        record.sum[0] += record.factor * values[i]
"""

CALL = """
import importlib, json, sys
import numpy as np
from total import total

record = importlib.import_module(sys.argv[1]).Law(2.0, np.zeros(1))
total(record, np.arange(4.0))
compiler = [name for name in ("numba.np.linalg", "numba.typed.listobject") if name in sys.modules]
print(json.dumps([record.sum[0], sum(total.stats.cache_hits.values()), bool(compiler)]))
"""

LAW = """
from typing import NamedTuple
import numpy as np

class Law(NamedTuple):
    factor: float
    sum: np.ndarray
"""


def test_a_second_process_finds_the_kernels_and_needs_no_compiler(tmp_path: Path) -> None:
    for name, text in {"total": MODULE, "first": LAW, "second": LAW}.items():
        (tmp_path / f"{name}.py").write_text(text)
    path = os.pathsep.join([str(tmp_path), str(Path(__file__).parents[2])])
    environment = {**os.environ, "PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}

    def call(home: str) -> list:
        command = [sys.executable, "-c", CALL, home]
        run = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        return json.loads(run.stdout)

    compiled, found = [12.0, 0, True], [12.0, 1, False]
    assert call("first") == compiled
    assert call("second") == compiled  # a namesake of the first class
    assert call("first") == found
    assert call("second") == found


def test_a_kernel_is_not_called_by_another() -> None:
    @kernel
    def inner(x):
        return 2.0 * x

    @kernel
    def outer(x):
        return inner(x) + 1.0

    assert inner(1.0) == 2.0
    with pytest.raises(TypeError, match="inner is a kernel"):
        outer(1.0)


def test_numba_is_whole_for_others() -> None:
    program = """
import solver.jit
import numba
from numba.experimental import jitclass

@jitclass([("x", numba.float64)])
class Point:
    def __init__(self, x):
        self.x = x

@numba.njit
def twice(x):
    return 2.0 * Point(x).x

assert twice(2.0) == 4.0
import importlib.metadata
print(importlib.metadata.version("numba") == numba.__version__, numba.experimental.jitclass is jitclass)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["True", "True"]


AHEAD = """
import importlib, json, sys
import numpy as np
import solver.jit.cache
from solver.jit.ahead import compile_ahead
from total import total

record, values = importlib.import_module("first").Law(2.0, np.zeros(1)), np.arange(4.0)
compile_ahead([(total, (record, values)), (total, (record, values))], 3)
elsewhere = list(solver.jit.cache._elsewhere.values())
if sys.argv[1] == "killed":
    elsewhere[0].kill()
total(record, values)
compile_ahead([(total, (record, values))], 3)
hits = sum(total.stats.cache_hits.values())
print(json.dumps([record.sum[0], hits, len(elsewhere), len(solver.jit.cache._elsewhere)]))
"""


@pytest.mark.parametrize(("fate", "loaded"), [("done", 1), ("killed", 0)])
def test_another_process_compiles_what_is_needed_later(tmp_path: Path, fate: str, loaded: int) -> None:
    """Once however often it is asked for; where it comes to harm, who needs the kernel compiles it."""
    for name, text in {"total": MODULE, "first": LAW}.items():
        (tmp_path / f"{name}.py").write_text(text)
    path = os.pathsep.join([str(tmp_path), str(Path(__file__).parents[2])])
    environment = {**os.environ, "PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    command = [sys.executable, "-c", AHEAD, fate]
    run = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert json.loads(run.stdout) == [12.0, loaded, 1, 1]


def test_helpers_get_no_machine_code_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    finish = JITCodeLibrary._finalize_specific
    monkeypatch.setattr(
        JITCodeLibrary, "_finalize_specific", lambda self: (made.append(self.name), finish(self))
    )

    @inline
    def twice(number):
        return number + number

    @kernel
    def double(numbers):
        for i in range(len(numbers)):
            numbers[i] = twice(numbers[i])

    numbers = np.arange(3.0)
    double(numbers)
    assert [name for name in made if "twice" in name or "double" in name] == [double.__qualname__]
    assert numbers.tolist() == [0.0, 2.0, 4.0]


def test_what_a_helper_knows_of_python_reaches_the_kernel_that_contains_it() -> None:
    @inline
    def root(number):
        if number < 0.0:
            raise ValueError("no root of", number)
        return number**0.5

    @njit  # kernels make no Python objects, not even of what went wrong
    def roots(numbers):
        for i in range(len(numbers)):
            numbers[i] = root(numbers[i])

    with pytest.raises(ValueError, match="no root of") as raised:
        roots(np.array([4.0, -1.0]))
    assert raised.value.args == ("no root of", -1.0)


@pytest.mark.parametrize("other", [np.arange(3), np.zeros((3, 1)), np.zeros((3, 2))[:, 0], (np.zeros(3),)])
def test_kernels_that_are_called_in_steps_are_given_the_same_types(other) -> None:
    @kernel
    def first(numbers):
        return numbers[0]

    call = Calls()
    assert call(first, np.array([2.0, 3.0])) == 2.0
    assert call(first, np.zeros(5)) == 0.0
    with pytest.raises(TypeError, match="first is called with values of other types"):
        call(first, other)
