"""The one place where numba is told about this program: tensors, generic functions, options, and the cache.

Import :func:`kernel` from here to compile a function. Compiled kernels are kept in a folder of the user's cache
named after the state of the solver's sources, so that a change in any model file makes new kernels.
"""

from __future__ import annotations

import hashlib
import operator
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar


def _cache_directory() -> Path:
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ups-mpm"
    root = Path(__file__).parent
    stamp = hashlib.sha256()
    for file in sorted(root.rglob("*.py")):
        status = file.stat()
        stamp.update(f"{file.relative_to(root)} {status.st_mtime_ns} {status.st_size}\n".encode())
    return base / stamp.hexdigest()[:16]


os.environ.setdefault("NUMBA_CACHE_DIR", str(_cache_directory()))
os.environ.setdefault("NUMBA_SLP_VECTORIZE", "1")  # transfers run 1.5 times as fast: rows of four at once


@contextmanager
def _without(package: str) -> Iterator[None]:
    """Make a package look absent to what is imported inside."""
    absent = package not in sys.modules
    if absent:
        sys.modules[package] = None  # type: ignore[assignment]  # Python's way to say: not to be found
    yield
    if absent:
        del sys.modules[package]


import numba  # noqa: E402 - the cache folder has to be known before numba is imported
from numba.core import cgutils, types  # noqa: E402 - after the cache folder, too
from numba.extending import (  # noqa: E402 - after the cache folder, too
    lower_builtin,
    make_attribute_wrapper,
    models,
    overload,
    overload_attribute,
    register_model,
    type_callable,
)

# For a numba that was imported before this module, and so did not read the environment set above.
numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]
numba.config.SLP_VECTORIZE = int(os.environ["NUMBA_SLP_VECTORIZE"])

with _without("scipy.linalg"):  # half a second of start-up to find a BLAS that no kernel here uses
    import numba.np.arraymath

from solver import dispatch, tensor  # noqa: E402 - after the cache folder, too
from solver.tensor import Tensor  # noqa: E402 - after the cache folder, too

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
"""Division by zero gives inf as in numpy. Sums are not reordered and divisions not replaced: where a particle just
touches a node, the last digit of its position decides whether the node takes part, as it does in Uintah."""

INLINED = {**OPTIONS, "forceinline": True}
"""Models and helpers are made part of the kernel that calls them: stresses take half to a fifth of the time."""

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function with numba for whatever models it is called with, cached on disk across runs."""
    return numba.njit(cache=True, no_cfunc_wrapper=True, **OPTIONS)(function)


class TensorType(types.Type):
    """Numba's view of :class:`solver.tensor.Tensor`."""

    def __init__(self) -> None:
        super().__init__(name="Tensor")


tensor_type = TensorType()


@register_model(TensorType)
class _TensorModel(models.StructModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        members = [(name, types.float64) for name in Tensor.__slots__]
        super().__init__(manager, fe_type, members)


for _name in Tensor.__slots__:
    make_attribute_wrapper(TensorType, _name, _name)


@type_callable(Tensor)
def _type_tensor(context: Any) -> Callable[..., Any]:
    def typer(xx: Any, xy: Any, xz: Any, yx: Any, yy: Any, yz: Any, zx: Any, zy: Any, zz: Any) -> Any:
        if all(isinstance(t, types.Number) for t in (xx, xy, xz, yx, yy, yz, zx, zy, zz)):
            return tensor_type
        return None

    return typer


@lower_builtin(Tensor, *[types.Number] * 9)
def _make_tensor(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    proxy = cgutils.create_struct_proxy(sig.return_type)(context, builder)
    for name, value, given in zip(Tensor.__slots__, args, sig.args, strict=True):
        setattr(proxy, name, context.cast(builder, value, given, types.float64))
    return proxy._getvalue()


def _is_tensor(*given: Any) -> bool:
    return all(isinstance(t, TensorType) for t in given)


@overload(operator.add, jit_options=INLINED, strict=False)
def _add(a: Any, b: Any) -> Any:
    return tensor.add if _is_tensor(a, b) else None


@overload(operator.sub, jit_options=INLINED, strict=False)
def _subtract(a: Any, b: Any) -> Any:
    return tensor.subtract if _is_tensor(a, b) else None


@overload(operator.matmul, jit_options=INLINED, strict=False)
def _matmul(a: Any, b: Any) -> Any:
    return tensor.matmul if _is_tensor(a, b) else None


@overload(operator.mul, jit_options=INLINED, strict=False)
def _multiply(a: Any, b: Any) -> Any:
    if _is_tensor(a) and isinstance(b, types.Number):
        return tensor.scale
    if isinstance(a, types.Number) and _is_tensor(b):
        return lambda a, b: tensor.scale(b, a)
    return None


@overload(operator.truediv, jit_options=INLINED, strict=False)
def _divide(a: Any, b: Any) -> Any:
    if _is_tensor(a) and isinstance(b, types.Number):
        return lambda a, b: tensor.scale(a, 1.0 / b)
    return None


@overload(operator.neg, jit_options=INLINED, strict=False)
def _negate(a: Any) -> Any:
    return (lambda a: tensor.scale(a, -1.0)) if _is_tensor(a) else None


@overload_attribute(TensorType, "T", jit_options=INLINED, strict=False)
def _transpose(a: Any) -> Any:
    return tensor.transpose


def _hand_to_numba(kind: str, function: Callable[..., Any]) -> None:
    if kind == "inline":

        def choose(*args: Any) -> Any:
            return function
    else:

        def choose(*args: Any) -> Any:
            chosen = getattr(args[0], "instance_class", None)
            return function.implementations.get(chosen, function.default)  # type: ignore[attr-defined]  # set by generic

    overload(function, jit_options=INLINED, strict=False)(choose)


dispatch.listen(_hand_to_numba)
