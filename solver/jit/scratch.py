"""Arrays on the stack of a kernel."""

from __future__ import annotations

import math
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import lower_builtin, type_callable

from solver import scratch

CACHE_LINE = 64


def _array_on_stack(context: Any, builder: Any, array_type: Any, lengths: list[int]) -> Any:
    from numba.np.arrayobj import populate_array  # here, as kernels that were compiled need none of it

    number = context.get_data_type(array_type.dtype)
    size = context.get_abi_sizeof(number)
    room = cgutils.alloca_once(builder, ir.ArrayType(number, math.prod(lengths)))
    room.align = CACHE_LINE
    array = context.make_array(array_type)(context, builder)
    strides = [math.prod(lengths[axis + 1 :]) * size for axis in range(len(lengths))]
    populate_array(
        array,
        data=builder.bitcast(room, number.as_pointer()),
        shape=[context.get_constant(types.intp, length) for length in lengths],
        strides=[context.get_constant(types.intp, stride) for stride in strides],
        itemsize=context.get_constant(types.intp, size),
        meminfo=None,
    )
    return array._getvalue()


@type_callable(scratch.scratch_numbers)
def _type_numbers(context: Any) -> Any:
    def typer(count: Any, dtype: Any) -> Any:
        return types.Array(dtype.dtype, 1, "C") if isinstance(count, types.IntegerLiteral) else None

    return typer


@type_callable(scratch.scratch_rows)
def _type_rows(context: Any) -> Any:
    def typer(count: Any, width: Any) -> Any:
        known = all(isinstance(length, types.IntegerLiteral) for length in (count, width))
        return types.Array(types.float64, 2, "C") if known else None

    return typer


@lower_builtin(scratch.scratch_numbers, types.IntegerLiteral, types.Any)
@lower_builtin(scratch.scratch_rows, types.IntegerLiteral, types.IntegerLiteral)
def _make(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    lengths = [length.literal_value for length in signature.args if isinstance(length, types.IntegerLiteral)]
    return _array_on_stack(context, builder, signature.return_type, lengths)
