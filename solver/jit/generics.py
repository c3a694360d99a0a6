"""Functions chosen by the class of a model, in kernels: for one particle, or for eight at once.

A body that cannot be given lanes is asked for one of the eight particles after the other, and its answers are put
together; so models for one particle serve where most of the work is done for eight.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.types.containers import BaseTuple
from numba.extending import intrinsic, overload

import solver.jit.lanes  # tells numba of lanes
import solver.jit.scratch  # tells numba of arrays on the stack
import solver.jit.tensors  # noqa: F401 - tells numba of tensors
from solver import dispatch
from solver.jit.compile import INLINED
from solver.jit.types import (
    MASK,
    VECTOR,
    EightType,
    LanesType,
    MaskType,
    TensorType,
    UpToEightType,
    lanes_type,
    mask_type,
    members_of,
    tensor_of_lanes,
    tensor_type,
    with_members,
)
from solver.lanes import WIDTH
from solver.tensor import Tensor

I32 = ir.IntType(32)


def _is_wide(given: Any) -> bool:
    """Whether a value holds numbers of eight particles."""
    if isinstance(given, TensorType):
        return given.number is lanes_type
    return isinstance(given, LanesType | MaskType | EightType | UpToEightType) or any(
        map(_is_wide, members_of(given))
    )


def _of_one(given: Any) -> Any:
    """The type of what one particle has of a value."""
    if not _is_wide(given):
        return given
    if isinstance(given, LanesType):
        return types.float64
    if isinstance(given, MaskType):
        return types.boolean
    if isinstance(given, EightType | UpToEightType):
        return types.intp
    if isinstance(given, TensorType):
        return tensor_type
    return with_members(given, [_of_one(member) for member in members_of(given)])


def _of_eight(given: Any) -> Any:
    """The type of the values of eight particles."""
    if isinstance(given, types.Boolean):
        return mask_type
    if isinstance(given, types.Number):
        return lanes_type
    if isinstance(given, TensorType):
        return tensor_of_lanes
    if isinstance(given, BaseTuple):
        return with_members(given, [_of_eight(member) for member in members_of(given)])
    return given


class _Numbers:
    """Where the numbers of eight particles lie in memory while each particle in turn is asked about."""

    def __init__(self, context: Any, builder: Any) -> None:
        self._context, self._builder = context, builder

    def room(self, vector: ir.VectorType) -> Any:
        """Space for eight numbers or truths."""
        element = ir.DoubleType() if vector == VECTOR else ir.IntType(8)
        return cgutils.alloca_once(self._builder, ir.ArrayType(element, WIDTH))

    def _element(self, room: Any, lane: Any) -> Any:
        return self._builder.gep(room, [I32(0), lane], inbounds=True)

    def lay_down(self, given: Any, value: Any) -> Any:
        """A value of eight particles as something that :meth:`take` finds one particle's part of."""
        builder = self._builder
        if isinstance(given, LanesType):
            room = self.room(VECTOR)
            builder.store(value, builder.bitcast(room, VECTOR.as_pointer()), align=8)
            return room
        if isinstance(given, MaskType):
            room = self.room(MASK)
            bytes_of = ir.VectorType(ir.IntType(8), WIDTH)
            builder.store(
                builder.zext(value, bytes_of), builder.bitcast(room, bytes_of.as_pointer()), align=1
            )
            return room
        if isinstance(given, TensorType) and _is_wide(given):
            proxy = cgutils.create_struct_proxy(given)(self._context, builder, value=value)
            return [self.lay_down(lanes_type, getattr(proxy, name)) for name in Tensor.__slots__]
        if isinstance(given, BaseTuple) and _is_wide(given):
            parts = cgutils.unpack_tuple(builder, value)
            return [self.lay_down(*pair) for pair in zip(members_of(given), parts, strict=True)]
        return value

    def take(self, given: Any, laid: Any, lane: Any) -> Any:
        """What one particle has of a value that was laid down."""
        context, builder = self._context, self._builder
        if isinstance(given, LanesType):
            return builder.load(self._element(laid, lane))
        if isinstance(given, MaskType):
            return builder.trunc(builder.load(self._element(laid, lane)), ir.IntType(1))
        if isinstance(given, EightType | UpToEightType):
            index = cgutils.create_struct_proxy(given)(context, builder, value=laid)
            p = builder.add(index.first, builder.zext(lane, index.first.type))
            if isinstance(given, EightType):
                return p
            return builder.select(builder.icmp_signed("<", p, index.last), p, index.last)
        if isinstance(given, TensorType) and _is_wide(given):
            proxy = cgutils.create_struct_proxy(tensor_type)(context, builder)
            for name, room in zip(Tensor.__slots__, laid, strict=True):
                setattr(proxy, name, self.take(lanes_type, room, lane))
            return proxy._getvalue()
        if isinstance(given, BaseTuple) and _is_wide(given):
            parts = [self.take(t, part, lane) for t, part in zip(members_of(given), laid, strict=True)]
            return context.make_tuple(builder, _of_one(given), parts)
        return laid

    def rooms_for(self, answer: Any) -> Any:
        """Space for the answers of eight particles; ``answer`` is the type of one."""
        if isinstance(answer, types.Boolean):
            return self.room(MASK)
        if isinstance(answer, types.Number):
            return self.room(VECTOR)
        if isinstance(answer, TensorType):
            return [self.room(VECTOR) for _ in Tensor.__slots__]
        return [self.rooms_for(member) for member in members_of(answer)]

    def put(self, answer: Any, rooms: Any, lane: Any, value: Any) -> None:
        """Store the answer of one particle."""
        context, builder = self._context, self._builder
        if isinstance(answer, types.Boolean):
            builder.store(builder.zext(value, ir.IntType(8)), self._element(rooms, lane))
        elif isinstance(answer, types.Number):
            number = context.cast(builder, value, answer, types.float64)
            builder.store(number, self._element(rooms, lane))
        elif isinstance(answer, TensorType):
            proxy = cgutils.create_struct_proxy(answer)(context, builder, value=value)
            for name, room in zip(Tensor.__slots__, rooms, strict=True):
                self.put(types.float64, room, lane, getattr(proxy, name))
        elif isinstance(answer, BaseTuple):
            parts = cgutils.unpack_tuple(builder, value)
            for member, room, part in zip(members_of(answer), rooms, parts, strict=True):
                self.put(member, room, lane, part)

    def gather(self, answer: Any, rooms: Any) -> Any:
        """The answers of all eight, as lanes."""
        context, builder = self._context, self._builder
        if isinstance(answer, types.Boolean):
            bytes_of = ir.VectorType(ir.IntType(8), WIDTH)
            loaded = builder.load(builder.bitcast(rooms, bytes_of.as_pointer()), align=1)
            return builder.trunc(loaded, MASK)
        if isinstance(answer, types.Number):
            return builder.load(builder.bitcast(rooms, VECTOR.as_pointer()), align=8)
        if isinstance(answer, TensorType):
            proxy = cgutils.create_struct_proxy(tensor_of_lanes)(context, builder)
            for name, room in zip(Tensor.__slots__, rooms, strict=True):
                setattr(proxy, name, self.gather(types.float64, room))
            return proxy._getvalue()
        if isinstance(answer, BaseTuple):
            parts = [self.gather(*pair) for pair in zip(members_of(answer), rooms, strict=True)]
            return context.make_tuple(builder, _of_eight(answer), parts)
        return context.get_dummy_value()


def _one_after_the_other(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that asks another for each of eight particles."""

    @intrinsic
    def ask(typing_context: Any, given: Any) -> Any:
        asked = typing_context.resolve_value_type(function)
        one = typing_context.resolve_function_type(asked, tuple(map(_of_one, members_of(given))), {})
        answer = one.return_type

        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            numbers = _Numbers(context, builder)
            call = context.get_function(asked, one)
            context.add_linking_libs(getattr(call, "libs", ()))
            laid = numbers.lay_down(given, args[0])
            rooms = numbers.rooms_for(answer)
            with cgutils.for_range(builder, I32(WIDTH), intp=I32) as loop:
                particle = [
                    context.cast(builder, numbers.take(t, part, loop.index), _of_one(t), wanted)
                    for t, part, wanted in zip(members_of(given), laid, one.args, strict=True)
                ]
                numbers.put(answer, rooms, loop.index, call(builder, particle))
            return numbers.gather(answer, rooms)

        return _of_eight(answer)(given), generate

    return lambda *args: ask(args)


def _hand_to_numba(kind: str, function: Callable[..., Any]) -> None:
    in_turn = _one_after_the_other(function)

    def choose(*args: Any) -> Any:
        body = function
        if kind == "generic":
            chosen = getattr(args[0], "instance_class", None)
            body = function.implementations.get(chosen, function.default)  # type: ignore[attr-defined]  # set by generic
        takes_lanes = kind == "inline" or dispatch.is_lanewise(function) or dispatch.is_lanewise(body)
        if takes_lanes or not any(map(_is_wide, args)):
            return body
        return in_turn

    overload(function, jit_options=INLINED, strict=False)(choose)


dispatch.listen(_hand_to_numba)
