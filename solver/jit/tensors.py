"""Tensors in kernels: nine numbers in registers, or nine times the lanes of eight particles."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import (
    intrinsic,
    lower_builtin,
    make_attribute_wrapper,
    overload,
    overload_attribute,
    type_callable,
)

from solver import tensor
from solver.jit.compile import INLINED
from solver.jit.types import (
    VECTOR,
    EightType,
    LanesType,
    TensorType,
    eight_type,
    lanes_type,
    tensor_of_lanes,
    tensor_type,
)
from solver.lanes import WIDTH
from solver.tensor import Tensor

I32, I64 = ir.IntType(32), ir.IntType(64)

for _name in Tensor.__slots__:
    make_attribute_wrapper(TensorType, _name, _name)


@type_callable(Tensor)
def _type_tensor(context: Any) -> Callable[..., Any]:
    def typer(xx: Any, xy: Any, xz: Any, yx: Any, yy: Any, yz: Any, zx: Any, zy: Any, zz: Any) -> Any:
        given = (xx, xy, xz, yx, yy, yz, zx, zy, zz)
        if not all(isinstance(t, types.Number | LanesType) for t in given):
            return None
        return tensor_of_lanes if any(t is lanes_type for t in given) else tensor_type

    return typer


def _make_tensor(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    proxy = cgutils.create_struct_proxy(sig.return_type)(context, builder)
    for name, value, given in zip(Tensor.__slots__, args, sig.args, strict=True):
        setattr(proxy, name, context.cast(builder, value, given, sig.return_type.number))
    return proxy._getvalue()


lower_builtin(Tensor, *[types.Any] * 9)(_make_tensor)


def _is_tensor(*given: Any) -> bool:
    return all(isinstance(t, TensorType) for t in given)


def _is_factor(given: Any) -> bool:
    return isinstance(given, types.Number | LanesType)


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
    if _is_tensor(a) and _is_factor(b):
        return tensor.scale
    if _is_factor(a) and _is_tensor(b):
        return lambda a, b: tensor.scale(b, a)
    return None


@overload(operator.truediv, jit_options=INLINED, strict=False)
def _divide(a: Any, b: Any) -> Any:
    if _is_tensor(a) and _is_factor(b):
        return lambda a, b: tensor.scale(a, 1.0 / b)
    return None


@overload(operator.neg, jit_options=INLINED, strict=False)
def _negate(a: Any) -> Any:
    return (lambda a: tensor.scale(a, -1.0)) if _is_tensor(a) else None


@overload_attribute(TensorType, "T", jit_options=INLINED, strict=False)
def _transpose(a: Any) -> Any:
    return tensor.transpose


# ---- tensors of eight particles ------------------------------------------------------------------------------


COMPONENTS = len(Tensor.__slots__)
LANES = ir.VectorType(I32, WIDTH)


def _transposed(builder: Any, rows: list[Any]) -> list[Any]:
    """Eight vectors of eight numbers as a matrix, transposed: blocks beside the diagonal change places."""
    for size in (1, 2, 4):
        low = ir.Constant(LANES, [j if not j & size else WIDTH + j - size for j in range(WIDTH)])
        high = ir.Constant(LANES, [j + size if not j & size else WIDTH + j for j in range(WIDTH)])
        for i in (i for i in range(WIDTH) if not i & size):
            pair = rows[i], rows[i + size]
            rows[i] = builder.shuffle_vector(*pair, low)
            rows[i + size] = builder.shuffle_vector(*pair, high)
    return rows


def _rows(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> list[tuple[Any, Any]]:
    """Addresses of the first eight components of each of eight particles, as a vector, and of the last."""
    first = cgutils.create_struct_proxy(eight_type)(context, builder, value=index).first
    data = context.make_array(array_type)(context, builder, array).data
    start = builder.gep(data, [builder.mul(first, I64(COMPONENTS))])
    places = [builder.gep(start, [I64(COMPONENTS * k)]) for k in range(WIDTH)]
    return [(builder.bitcast(p, VECTOR.as_pointer()), builder.gep(p, [I64(WIDTH)])) for p in places]


@intrinsic
def _load_tensors(typing_context: Any, array: Any, index: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        places = _rows(context, builder, signature.args[0], *args)
        components = _transposed(builder, [builder.load(row, align=8) for row, _ in places])
        last = ir.Constant(VECTOR, ir.Undefined)
        for k, (_, place) in enumerate(places):
            last = builder.insert_element(last, builder.load(place), I32(k))
        proxy = cgutils.create_struct_proxy(tensor_of_lanes)(context, builder)
        for name, component in zip(Tensor.__slots__, [*components, last], strict=True):
            setattr(proxy, name, component)
        return proxy._getvalue()

    return tensor_of_lanes(array, index), generate


@intrinsic
def _store_tensors(typing_context: Any, array: Any, index: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        places = _rows(context, builder, signature.args[0], *args[:2])
        proxy = cgutils.create_struct_proxy(tensor_of_lanes)(context, builder, value=args[2])
        *components, last = (getattr(proxy, name) for name in Tensor.__slots__)
        for k, row in enumerate(_transposed(builder, components)):
            builder.store(row, places[k][0], align=8)
            builder.store(builder.extract_element(last, I32(k)), places[k][1])
        return context.get_dummy_value()

    return types.void(array, index, tensor_of_lanes), generate


@overload(tensor.tensor_at, jit_options=INLINED, strict=False)
def _tensor_at(array: Any, p: Any) -> Any:
    return (lambda array, p: _load_tensors(array, p)) if isinstance(p, EightType) else tensor.tensor_at


@overload(tensor.put_tensor, jit_options=INLINED, strict=False)
def _put_tensor(array: Any, p: Any, a: Any) -> Any:
    if isinstance(p, EightType):
        return lambda array, p, a: _store_tensors(array, p, a)
    return tensor.put_tensor
