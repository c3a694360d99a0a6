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
from llvmlite import ir  # noqa: E402 - comes with numba
from numba.core import cgutils, types  # noqa: E402 - after the cache folder, too
from numba.extending import (  # noqa: E402 - after the cache folder, too
    intrinsic,
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

with _without("scipy.linalg"):  # half a second of start-up to find a BLAS that no kernel here uses
    import numba.np.arraymath

from solver import dispatch, lanes, tensor  # noqa: E402 - after the cache folder, too
from solver.lanes import WIDTH, Lanes  # noqa: E402 - after the cache folder, too
from solver.tensor import Tensor  # noqa: E402 - after the cache folder, too

OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
"""Division by zero gives inf as in numpy. Sums are not reordered and divisions not replaced: where a particle just
touches a node, the last digit of its position decides whether the node takes part, as it does in Uintah."""

INLINED = {**OPTIONS, "forceinline": True}
"""Models and helpers are made part of the kernel that calls them: stresses take half to a fifth of the time."""

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function with numba for whatever models it is called with, cached on disk across runs.

    While it runs, other threads of Python go on.
    """
    return numba.njit(cache=True, nogil=True, no_cfunc_wrapper=True, **OPTIONS)(function)


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


# ---- lanes ---------------------------------------------------------------------------------------------------

VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
CONTRACT = ("contract", "nsz")


class LanesType(types.Type):
    """Numba's view of :class:`solver.lanes.Lanes`: one vector."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


lanes_type = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, VECTOR)


@type_callable(Lanes)
def _type_lanes(context: Any) -> Callable[..., Any]:
    def typer(a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any, h: Any) -> Any:
        return lanes_type if all(isinstance(t, types.Number) for t in (a, b, c, d, e, f, g, h)) else None

    return typer


@lower_builtin(Lanes, *[types.Number] * WIDTH)
def _make_lanes(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    vector = ir.Constant(VECTOR, ir.Undefined)
    for k, (value, given) in enumerate(zip(args, sig.args, strict=True)):
        number = context.cast(builder, value, given, types.float64)
        vector = builder.insert_element(vector, number, ir.Constant(ir.IntType(32), k))
    return vector


def _spread(builder: Any, number: Any) -> Any:
    """A number in every lane."""
    one = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(VECTOR, ir.Undefined), zeros)


def _of_two(operation: Callable[..., Any]) -> Any:
    """An intrinsic on two lanes, lane by lane."""

    @intrinsic
    def combine(context: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return operation(builder, *args)

        return lanes_type(lanes_type, lanes_type), generate

    return combine


_add_lanes = _of_two(lambda builder, a, b: builder.fadd(a, b, flags=CONTRACT))
_subtract_lanes = _of_two(lambda builder, a, b: builder.fsub(a, b, flags=CONTRACT))
_multiply_lanes = _of_two(lambda builder, a, b: builder.fmul(a, b, flags=CONTRACT))
_divide_lanes = _of_two(lambda builder, a, b: builder.fdiv(a, b, flags=CONTRACT))
_above_lanes = _of_two(lambda builder, a, b: builder.uitofp(builder.fcmp_ordered(">", a, b), VECTOR))


@intrinsic
def _spread_number(context: Any, number: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _spread(builder, args[0])

    return lanes_type(types.float64), generate


@intrinsic
def _floor_lanes(context: Any, a: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        name = f"llvm.floor.v{WIDTH}f64"
        floor = cgutils.get_or_insert_function(builder.module, ir.FunctionType(VECTOR, [VECTOR]), name)
        return builder.call(floor, args)

    return lanes_type(lanes_type), generate


@intrinsic
def _add_scaled_lanes(context: Any, total: Any, part: Any, factor: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        kind = ir.FunctionType(VECTOR, [VECTOR] * 3)
        fma = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fma.v{WIDTH}f64")
        return builder.call(fma, [args[1], _spread(builder, args[2]), args[0]])

    return lanes_type(lanes_type, lanes_type, types.float64), generate


@intrinsic
def _lane(context: Any, a: Any, k: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.extract_element(*args)

    return types.float64(lanes_type, types.intp), generate


def _place(context: Any, builder: Any, rows_type: Any, rows: Any, row: Any, start: Any) -> Any:
    """Address of ``rows[row, start]`` of a C-contiguous array, as that of a vector."""
    array = context.make_array(rows_type)(context, builder, rows)
    width = builder.extract_value(array.shape, 1)
    position = builder.add(builder.mul(row, width), start)
    return builder.bitcast(builder.gep(array.data, [position]), VECTOR.as_pointer())


@intrinsic
def _load_lanes(context: Any, rows: Any, row: Any, start: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_place(context, builder, signature.args[0], *args), align=8)

    return lanes_type(rows, types.uintp, types.uintp), generate


@intrinsic
def _store_lanes(context: Any, rows: Any, row: Any, start: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[3], _place(context, builder, signature.args[0], *args[:3]), align=8)
        return context.get_dummy_value()

    return types.void(rows, types.uintp, types.uintp, lanes_type), generate


def _let_lanes(function: Callable[..., Any], combine: Any) -> None:
    """Tell numba how a function of two goes with lanes, or with lanes and a number."""

    @overload(function, jit_options=INLINED, strict=False)
    def choose(a: Any, b: Any) -> Any:
        left, right = isinstance(a, LanesType), isinstance(b, LanesType)
        if left and right:
            return lambda a, b: combine(a, b)
        if left and isinstance(b, types.Number):
            return lambda a, b: combine(a, _spread_number(b))
        if right and isinstance(a, types.Number):
            return lambda a, b: combine(_spread_number(a), b)
        return None


_let_lanes(operator.add, _add_lanes)
_let_lanes(operator.sub, _subtract_lanes)
_let_lanes(operator.mul, _multiply_lanes)
_let_lanes(operator.truediv, _divide_lanes)
_let_lanes(lanes.above, _above_lanes)


@overload(lanes.floor, jit_options=INLINED, strict=False)
def _floor(a: Any) -> Any:
    return lambda a: _floor_lanes(a)


@overload(operator.getitem, jit_options=INLINED, strict=False)
def _get_lane(a: Any, k: Any) -> Any:
    return (lambda a, k: _lane(a, k)) if isinstance(a, LanesType) else None


@overload(lanes.add_scaled, jit_options=INLINED, strict=False)
def _add_scaled(total: Any, part: Any, factor: Any) -> Any:
    return lambda total, part, factor: _add_scaled_lanes(total, part, factor)


@overload(lanes.lanes_at, jit_options=INLINED, strict=False)
def _lanes_at(rows: Any, row: Any, start: Any) -> Any:
    return lambda rows, row, start: _load_lanes(rows, row, start)


@overload(lanes.put_lanes, jit_options=INLINED, strict=False)
def _put_lanes(rows: Any, row: Any, start: Any, lanes: Any) -> Any:
    return lambda rows, row, start, lanes: _store_lanes(rows, row, start, lanes)


# ---- generic functions and models ----------------------------------------------------------------------------


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
