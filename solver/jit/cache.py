"""Kernels that are kept on disk, and a numba that is imported without what only compiling needs.

The kernels are in a folder of the user's cache named after the state of the solver's sources, so that a change in any
model file makes new ones. Import numba from here, so that it knows the folder.
"""

from __future__ import annotations

import gc
import hashlib
import importlib.util
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any


def _folder() -> Path:
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ups-mpm"
    root = os.path.dirname(os.path.dirname(__file__))
    stamp = hashlib.sha256()
    for folder, _, files in sorted(os.walk(root)):
        for file in sorted(file for file in files if file.endswith(".py")):
            status = os.stat(os.path.join(folder, file))
            stamp.update(f"{folder[len(root) :]}/{file} {status.st_mtime_ns} {status.st_size}\n".encode())
    return base / stamp.hexdigest()[:16]


os.environ.setdefault("NUMBA_CACHE_DIR", str(_folder()))


@contextmanager
def _without(*names: str) -> Iterator[None]:
    """Make modules look absent to what is imported inside."""
    absent = [name for name in names if name not in sys.modules]
    for name in absent:
        sys.modules[name] = None  # type: ignore[assignment]  # Python's way to say: not to be found
    try:
        yield
    finally:
        for name in absent:
            del sys.modules[name]


def _on_demand(name: str) -> None:
    """Import a module when something in it is first asked for."""
    if name in sys.modules:
        return
    spec = importlib.util.find_spec(name)
    assert spec is not None
    assert spec.loader is not None
    spec.loader = importlib.util.LazyLoader(spec.loader)
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    package, _, own = name.rpartition(".")
    setattr(sys.modules[package], own, module)


# Numba reads settings by yaml where it is installed, looks at the version of scipy, has compiled classes, which nothing
# here uses, and reads what all installed packages declare: a fifth of the time that its import takes.
_on_demand("importlib.metadata")
_classes = ModuleType("numba.experimental")
if "numba" not in sys.modules:
    sys.modules[_classes.__name__] = _classes
with _without("yaml", "scipy"):
    import numba
if numba.experimental is _classes:
    del sys.modules[_classes.__name__]
    _on_demand(_classes.__name__)

from llvmlite import binding as llvm  # noqa: E402 - comes with numba
from numba.core import event  # noqa: E402 - after numba
from numba.core.caching import (  # noqa: E402 - after numba
    CompileResultCacheImpl,
    FunctionCache,
    IndexDataCacheFile,
)
from numba.core.compiler_lock import global_compiler_lock  # noqa: E402 - after numba
from numba.core.registry import CPUDispatcher  # noqa: E402 - after numba
from numba.core.runtime import _nrt_python  # noqa: E402 - after numba

# For a numba that was imported before this module, and so did not read the environment set above.
numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]


SECONDS_BETWEEN_LOOKS = 0.02

_elsewhere: dict[tuple[Kernel, Any], subprocess.Popen[bytes]] = {}
"""Processes that compile a kernel for arguments of some types."""


@contextmanager
def _collecting_seldom() -> Iterator[None]:
    """Look for dead objects in cycles seldom: a compiler makes many that live, and a seventh of its time went there."""
    first, *others = gc.get_threshold()  # the first is 0 where nobody looks
    gc.set_threshold(first and max(first, 500_000), *others)
    try:
        yield
    finally:
        gc.set_threshold(first, *others)


class Kernel(CPUDispatcher):
    """A function that numba compiles for the types of its arguments, or finds on disk.

    Extensions that other packages bring to numba are looked for when it compiles, not at the first call.
    """

    _cache: Any

    def enable_caching(self) -> None:
        """Look on the disk before compiling."""
        if not isinstance(
            self._cache, _Cache
        ):  # at the first call, as most kernels are never called in a run
            self._cache = _Cache(self.py_func)

    def compile(self, sig: Any) -> Any:
        """Machine code for arguments of some types."""
        self.enable_caching()
        compiler = _elsewhere.get((self, sig))  # several threads may ask
        if compiler is not None and compiler.poll() is None:
            with event.trigger_event("numba:compile", data={"dispatcher": self, "args": sig}):
                while compiler.poll() is None and not self.is_stored(sig):
                    time.sleep(SECONDS_BETWEEN_LOOKS)
        with global_compiler_lock, _collecting_seldom():
            return super().compile(sig)

    def for_types_of(self, *values: Any) -> Callable[..., Any]:
        """The kernel for values of these types, as a function that does not look at types."""
        signature = tuple(map(self.typeof_pyval, values))
        if signature not in self.overloads:
            self.compile(signature)
        return self.overloads[signature].entry_point

    def is_stored(self, sig: Any) -> bool:
        """Whether machine code for arguments of some types is on the disk."""
        self.enable_caching()
        return self._cache.holds(sig, self.targetctx)

    def is_compiled_by(self, process: subprocess.Popen[bytes], sig: Any) -> None:
        """Another process compiles it for arguments of some types; it is waited for when it is needed."""
        _elsewhere[self, sig] = process

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Refuse to be called by another kernel: what is kept of a kernel cannot be made part of one."""
        raise TypeError(f"{self.__name__} is a kernel; what kernels call is marked by solver.dispatch.inline")

    def _compilation_chain_init_hook(self) -> None:
        pass


class _Storing(CompileResultCacheImpl):
    """What is stored of a kernel: its machine code, and of the modules of what it calls only those it needs.

    The code that numba adds, for other kernels to contain it, takes longer to read than the machine code.
    """

    def reduce(self, compiled: Any) -> Any:
        """The parts of what the compiler made that are stored."""
        (name, kind, (machine_code, _)), function, *others, environments = super().reduce(compiled)
        entries = _defining(function.llvm_func_name, function.llvm_cpython_wrapper_name)
        needed = [environment for environment in environments if environment.consts]
        return (name, kind, (machine_code, entries)), function, *others, needed


def _defining(*functions: str) -> bytes:
    """Code that says of functions that they are there."""
    text = "\n".join(f'define void @"{name}"() {{ ret void }}' for name in functions)
    return bytes(llvm.parse_assembly(text).as_bitcode())


class _Files(IndexDataCacheFile):
    """A file for each kernel and types of arguments, without an index, which would need the classes of all models."""

    def save(self, key: Any, data: Any) -> None:
        """Write the file."""
        self._save_data(self._name(key), data)

    def load(self, key: Any) -> Any:
        """What the file holds, or None."""
        try:
            return self._load_data(self._name(key))
        except OSError:
            return None

    def holds(self, key: Any) -> bool:
        """Whether there is such a file."""
        return os.path.exists(self._data_path(self._name(key)))

    def _name(self, key: Any) -> str:
        types, *others = key
        text = repr((self._version, self._source_stamp, others, [_spelled(kind) for kind in types]))
        return self._index_name.replace(".nbi", f".{hashlib.sha256(text.encode()).hexdigest()[:24]}.nbc")


def _spelled(kind: Any) -> tuple[str, ...]:
    """The name of a type of numba's, and the modules of the classes in it, as classes may have namesakes."""
    own = getattr(kind, "instance_class", None)
    inner = (module for part in getattr(kind, "types", ()) for module in _spelled(part)[1:])
    return str(kind), *([own.__module__] if own is not None else []), *inner


class _Cache(FunctionCache):
    """Kernels on disk; the compiler is made ready only where one is missing, which takes a tenth of a second."""

    _impl_class = _Storing

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp)

    def holds(self, sig: Any, target_context: Any) -> bool:
        """Whether the kernel for arguments of some types is on the disk."""
        return self._cache_file.holds(self._index_key(sig, target_context.codegen()))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The kernel for arguments of some types, or None."""
        _offer_runtime()
        with self._guard_against_spurious_io_errors():
            found = self._load_overload(sig, target_context)
        if found is None:
            with _without("scipy.linalg"):  # half a second to find a BLAS that no kernel here uses
                importlib.import_module("numba.np.arraymath")
        return found


@cache
def _offer_runtime() -> None:
    """Let kernels find the functions that make arrays. Numba would compile some more, which kernels contain."""
    for name, address in _nrt_python.c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)
