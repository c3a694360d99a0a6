"""Numba's types for the values that kernels compute with."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typeconv import Conversion
from numba.core.types.containers import BaseNamedTuple, BaseTuple
from numba.extending import lower_cast, models, register_model

from solver.jit.compile import OPTIONS
from solver.lanes import WIDTH
from solver.tensor import Tensor

VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
MASK = ir.VectorType(ir.IntType(1), WIDTH)
FASTMATH = tuple(sorted(OPTIONS["fastmath"]))


class LanesType(types.Type):
    """Numba's view of :class:`solver.lanes.Lanes`: one vector. A number goes where lanes are wanted."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")

    def can_convert_from(self, context: Any, other: Any) -> Any:
        """Numbers, spread to all lanes."""
        return Conversion.safe if isinstance(other, types.Number) else None

    def unify(self, context: Any, other: Any) -> Any:
        """Lanes, where one branch gives lanes and the other a number."""
        return self if isinstance(other, types.Number) else None


class MaskType(types.Type):
    """Numba's view of a comparison of lanes: a truth in each. One truth goes where a mask is wanted."""

    def __init__(self) -> None:
        super().__init__(name="Mask")

    def can_convert_from(self, context: Any, other: Any) -> Any:
        """Truths, spread to all lanes."""
        return Conversion.safe if isinstance(other, types.Boolean) else None

    def unify(self, context: Any, other: Any) -> Any:
        """A mask, where one branch gives a mask and the other a truth."""
        return self if isinstance(other, types.Boolean) else None


class EightType(types.Type):
    """Numba's view of :class:`solver.lanes.Eight`."""

    def __init__(self) -> None:
        super().__init__(name="Eight")


class UpToEightType(types.Type):
    """Numba's view of :class:`solver.lanes.UpToEight`."""

    def __init__(self) -> None:
        super().__init__(name="UpToEight")


class TensorType(types.Type):
    """Numba's view of :class:`solver.tensor.Tensor`, of numbers or of lanes."""

    def __init__(self, number: Any) -> None:
        self.number = number
        super().__init__(name=f"Tensor({number})")

    def can_convert_from(self, context: Any, other: Any) -> Any:
        """A tensor of numbers, spread to all lanes."""
        return Conversion.safe if self is tensor_of_lanes and other is tensor_type else None

    def unify(self, context: Any, other: Any) -> Any:
        """The tensor of lanes, where one branch gives that and the other a tensor of numbers."""
        return tensor_of_lanes if isinstance(other, TensorType) else None


lanes_type = LanesType()
mask_type = MaskType()
eight_type = EightType()
up_to_eight_type = UpToEightType()
tensor_type = TensorType(types.float64)
tensor_of_lanes = TensorType(lanes_type)


def members_of(given: Any) -> tuple[Any, ...]:
    """The types of what a value consists of, if it is a tuple."""
    return tuple(given.types) if isinstance(given, BaseTuple) else ()


def with_members(given: BaseTuple, members: list[Any]) -> Any:
    """The type of a tuple of the same kind with other members."""
    if isinstance(given, BaseNamedTuple):
        return BaseTuple.from_types(members, given.instance_class)
    return BaseTuple.from_types(members)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, VECTOR)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, MASK)


@register_model(EightType)
class _EightModel(models.StructModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, [("first", types.uintp)])


@register_model(UpToEightType)
class _UpToEightModel(models.StructModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, [("first", types.intp), ("last", types.intp)])


@register_model(TensorType)
class _TensorModel(models.StructModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, [(name, fe_type.number) for name in Tensor.__slots__])


def spread(builder: Any, number: Any) -> Any:
    """A number, or a truth, in every lane."""
    vector = ir.VectorType(number.type, WIDTH)
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), zeros)


@lower_cast(types.Number, LanesType)
def _number_to_lanes(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    return spread(builder, context.cast(builder, value, given, types.float64))


@lower_cast(types.Boolean, MaskType)
def _truth_to_mask(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    return spread(builder, value)


@lower_cast(TensorType, TensorType)
def _tensor_to_lanes(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    numbers = cgutils.create_struct_proxy(given)(context, builder, value=value)
    lanes = cgutils.create_struct_proxy(wanted)(context, builder)
    for name in Tensor.__slots__:
        setattr(lanes, name, spread(builder, getattr(numbers, name)))
    return lanes._getvalue()
