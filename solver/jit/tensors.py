"""Tensors in kernels: nine numbers in registers, or nine times the lanes of eight particles."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from numba.core import cgutils, types
from numba.extending import (
    lower_builtin,
    make_attribute_wrapper,
    overload,
    overload_attribute,
    type_callable,
)

from solver import tensor
from solver.jit.compile import INLINED
from solver.jit.types import LanesType, TensorType, lanes_type, tensor_of_lanes, tensor_type
from solver.tensor import Tensor

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
