"""Lanes in kernels: vectors, masks, and the arrays that eight particles index."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.types.containers import BaseTuple
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import intrinsic, lower_builtin, overload, type_callable

from solver import elementary, lanes, tensor
from solver.jit.compile import INLINED
from solver.jit.types import (
    FASTMATH,
    VECTOR,
    EightType,
    LanesType,
    MaskType,
    TensorType,
    UpToEightType,
    eight_type,
    lanes_type,
    mask_type,
    members_of,
    tensor_of_lanes,
    up_to_eight_type,
    with_members,
)
from solver.lanes import WIDTH, Eight, Lanes, UpToEight

I32, I64 = ir.IntType(32), ir.IntType(64)


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
        vector = builder.insert_element(vector, number, I32(k))
    return vector


# ---- arithmetic and comparisons ------------------------------------------------------------------------------


SINGLE = {lanes_type: types.Number, mask_type: types.Boolean, types.intp: types.Integer}
"""What goes where lanes, a mask or a number of a lane is wanted."""


def _direct(
    function: Callable[..., Any], generate: Callable[..., Any], answer: Any, *given: Any, exact: int = 0
) -> None:
    """Tell numba the instructions of a function, to stand where it is called: sooner compiled than a function is.

    It takes values of the types ``given``; the first ``exact`` as they are, of the others all but one may be single.
    """

    class Instructions(AbstractTemplate):
        key = function

        def generic(self, args: Any, kws: Any) -> Any:
            if kws or len(args) != len(given) or args[:exact] != given[:exact]:
                return None
            same = [a == wanted for a, wanted in zip(args, given, strict=True)]
            single = [isinstance(a, SINGLE[wanted]) for a, wanted in zip(args, given, strict=True)]
            return answer(*given) if any(same) and all(map(operator.or_, same, single)) else None

    infer_global(function, types.Function(Instructions))
    lower_builtin(function, *given)(lambda context, builder, signature, args: generate(builder, *args))


def _of_two(
    instruction: Callable[..., Any], *functions: Callable[..., Any], answer: Any = lanes_type
) -> None:
    """Functions of two lanes, or of lanes and a number, lane by lane."""
    for function in functions:
        _direct(function, instruction, answer, lanes_type, lanes_type)


def _pick(builder: Any, comparison: str, a: Any, b: Any) -> Any:
    """The one of two, ``b`` where it compares so with ``a``, as Python's max and min."""
    return builder.select(builder.fcmp_ordered(comparison, b, a), b, a)


_of_two(lambda b, x, y: b.fadd(x, y, flags=FASTMATH), operator.add, operator.iadd)
_of_two(lambda b, x, y: b.fsub(x, y, flags=FASTMATH), operator.sub, operator.isub)
_of_two(lambda b, x, y: b.fmul(x, y, flags=FASTMATH), operator.mul, operator.imul)
_of_two(lambda b, x, y: b.fdiv(x, y, flags=FASTMATH), operator.truediv)
_of_two(lambda b, x, y: _pick(b, ">", x, y), max)
_of_two(lambda b, x, y: _pick(b, "<", x, y), min)
_of_two(lambda b, x, y: b.uitofp(b.fcmp_ordered(">", x, y), VECTOR), lanes.above)
for _operator, _sign in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.eq, "=="),
):
    _of_two(lambda b, x, y, sign=_sign: b.fcmp_ordered(sign, x, y), _operator, answer=mask_type)
_of_two(lambda b, x, y: b.fcmp_unordered("!=", x, y), operator.ne, answer=mask_type)

for _operator in (operator.and_, operator.iand):
    _direct(_operator, lambda b, x, y: b.and_(x, y), mask_type, mask_type, mask_type)
for _operator in (operator.or_, operator.ior):
    _direct(_operator, lambda b, x, y: b.or_(x, y), mask_type, mask_type, mask_type)
_direct(lanes.negation, lambda b, x: b.not_(x), mask_type, mask_type)


@overload(lanes.negation, jit_options=INLINED, strict=False)
def _negation(mask: Any) -> Any:
    return (lambda mask: not mask) if isinstance(mask, types.Boolean) else None


def _bits(builder: Any, mask: Any) -> Any:
    """The truths of a mask as the bits of a number."""
    return builder.bitcast(mask, ir.IntType(WIDTH))


_TRUTHS = ir.IntType(WIDTH)
_direct(lanes.anywhere, lambda b, x: b.icmp_unsigned("!=", _bits(b, x), _TRUTHS(0)), types.boolean, mask_type)
_direct(
    lanes.everywhere, lambda b, x: b.icmp_unsigned("==", _bits(b, x), _TRUTHS(255)), types.boolean, mask_type
)
for _answer in (lanes_type, mask_type):
    _direct(lanes.where, lambda b, *args: b.select(*args), _answer, mask_type, _answer, _answer, exact=1)


@overload(lanes.anywhere, jit_options=INLINED, strict=False)
@overload(lanes.everywhere, jit_options=INLINED, strict=False)
def _of_one_truth(condition: Any) -> Any:
    return (lambda condition: condition) if isinstance(condition, types.Boolean) else None


def _choice(a: Any, b: Any) -> Any:
    """The type of what is chosen of two, lane by lane."""
    if isinstance(a, BaseTuple):
        return with_members(a, list(map(_choice, members_of(a), members_of(b))))
    if isinstance(a, TensorType):
        return tensor_of_lanes
    return mask_type if all(isinstance(t, MaskType | types.Boolean) for t in (a, b)) else lanes_type


def _parts(context: Any, builder: Any, given: Any, value: Any) -> list[tuple[Any, Any]]:
    """What a record or tensor consists of, each with its type."""
    if isinstance(given, BaseTuple):
        return list(zip(members_of(given), cgutils.unpack_tuple(builder, value), strict=True))
    proxy = cgutils.create_struct_proxy(given)(context, builder, value=value)
    return [(given.number, getattr(proxy, name)) for name in tensor.Tensor.__slots__]


def _put_together(context: Any, builder: Any, wanted: Any, values: list[Any]) -> Any:
    """A record or tensor of its parts."""
    if isinstance(wanted, BaseTuple):
        return context.make_tuple(builder, wanted, values)
    proxy = cgutils.create_struct_proxy(wanted)(context, builder)
    for name, value in zip(tensor.Tensor.__slots__, values, strict=True):
        setattr(proxy, name, value)
    return proxy._getvalue()


def _chosen(context: Any, builder: Any, mask: Any, a: tuple[Any, Any], b: tuple[Any, Any]) -> Any:
    """The choice of two values, each given with its type."""
    answer = _choice(a[0], b[0])
    if isinstance(answer, BaseTuple | TensorType):
        parts = zip(_parts(context, builder, *a), _parts(context, builder, *b), strict=True)
        return _put_together(
            context, builder, answer, [_chosen(context, builder, mask, *pair) for pair in parts]
        )
    wide = [context.cast(builder, value, given, answer) for given, value in (a, b)]
    return builder.select(mask, *wide)


@intrinsic
def _select(context: Any, mask: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        _, given_a, given_b = signature.args
        return _chosen(context, builder, args[0], (given_a, args[1]), (given_b, args[2]))

    return _choice(a, b)(mask_type, a, b), generate


@overload(lanes.where, jit_options=INLINED, strict=False)
def _where(condition: Any, a: Any, b: Any) -> Any:
    if not isinstance(condition, MaskType):
        return lambda condition, a, b: a if condition else b
    if isinstance(a, LanesType | MaskType) or isinstance(b, LanesType | MaskType):
        return None  # instructions, see above
    return lambda condition, a, b: _select(condition, a, b)


@intrinsic
def _as_wide(context: Any, value: Any, pattern: Any) -> Any:
    return pattern(pattern, pattern), lambda _, builder, signature, args: args[0]


@overload(lanes.like, jit_options=INLINED, strict=False)
def _like(value: Any, pattern: Any) -> Any:
    if isinstance(pattern, LanesType | MaskType):
        return lambda value, pattern: _as_wide(value, pattern)
    return lambda value, pattern: value


# ---- functions of one ----------------------------------------------------------------------------------------


def _of_one(name: str) -> Callable[..., Any]:
    """LLVM's function of that name, lane by lane."""
    kind = ir.FunctionType(VECTOR, [VECTOR])

    def generate(builder: Any, a: Any) -> Any:
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{WIDTH}f64")
        return builder.call(function, [a])

    return generate


def _let_one(function: Callable[..., Any], body: Callable[..., Any]) -> None:
    """Tell numba how a function of one goes with lanes."""

    @overload(function, jit_options=INLINED, strict=False)
    def choose(a: Any) -> Any:
        return body if isinstance(a, LanesType) else None


_direct(math.sqrt, _of_one("sqrt"), lanes_type, lanes_type)
_direct(abs, _of_one("fabs"), lanes_type, lanes_type)
_direct(lanes.floor, _of_one("floor"), lanes_type, lanes_type)
_let_one(math.exp, elementary.exponential)
_let_one(math.log, elementary.logarithm)
_let_one(math.sinh, elementary.hyperbolic_sine)
_let_one(math.cosh, elementary.hyperbolic_cosine)
_let_one(math.tanh, elementary.hyperbolic_tangent)
_let_one(math.erf, elementary.error_function)
_let_one(math.isfinite, lambda a: abs(a) < math.inf)
_let_one(operator.neg, lambda a: -1.0 * a)


WHOLE_POWERS: dict[int, Callable[..., Any]] = {
    2: lambda a, b: a * a,
    3: lambda a, b: a * a * a,
    4: lambda a, b: (a * a) * (a * a),
}


@overload(operator.pow, jit_options=INLINED, strict=False)
def _power(a: Any, b: Any) -> Any:
    if isinstance(a, LanesType) and isinstance(b, types.IntegerLiteral):
        return WHOLE_POWERS.get(b.literal_value)
    if isinstance(a, LanesType) and isinstance(b, LanesType | types.Float):
        return elementary.power
    if isinstance(a, types.Float) and isinstance(b, LanesType):
        return lambda a, b: elementary.power(lanes.every(a), b)
    return None


@overload(lanes.floor, jit_options=INLINED, strict=False)
def _floor(a: Any) -> Any:
    return (lambda a: float(math.floor(a))) if isinstance(a, types.Number) else None


INTEGERS = ir.VectorType(I64, WIDTH)


def _integers(number: int) -> Any:
    """A whole number in every lane."""
    return ir.Constant(INTEGERS, [number] * WIDTH)


FRACTION_BITS = 52
BIAS = 1023
"""Of the exponents of double precision."""


def _exponent(builder: Any, a: Any) -> Any:
    biased = builder.lshr(builder.bitcast(a, INTEGERS), _integers(FRACTION_BITS))
    return builder.sitofp(builder.sub(biased, _integers(BIAS)), VECTOR)


def _mantissa(builder: Any, a: Any) -> Any:
    fraction = builder.and_(builder.bitcast(a, INTEGERS), _integers((1 << FRACTION_BITS) - 1))
    return builder.bitcast(builder.or_(fraction, _integers(BIAS << FRACTION_BITS)), VECTOR)


def _power_of_two(builder: Any, n: Any) -> Any:
    biased = builder.add(builder.fptosi(n, INTEGERS), _integers(BIAS))
    return builder.bitcast(builder.shl(biased, _integers(FRACTION_BITS)), VECTOR)


_direct(elementary.exponent, _exponent, lanes_type, lanes_type)
_direct(elementary.mantissa, _mantissa, lanes_type, lanes_type)
_direct(elementary.power_of_two, _power_of_two, lanes_type, lanes_type)


def _multiply_add(builder: Any, total: Any, part: Any, factor: Any) -> Any:
    kind = ir.FunctionType(VECTOR, [VECTOR] * 3)
    fma = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fma.v{WIDTH}f64")
    return builder.call(fma, [part, factor, total])


_direct(lanes.add_scaled, _multiply_add, lanes_type, lanes_type, lanes_type, lanes_type)


# ---- lanes of lanes ------------------------------------------------------------------------------------------


_direct(
    operator.getitem, lambda b, a, k: b.extract_element(a, k), types.float64, lanes_type, types.intp, exact=1
)


@overload(lanes.sum_of, jit_options=INLINED, strict=False)
def _sum_of(a: Any) -> Any:
    if isinstance(a, LanesType):
        return lambda a: ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]))
    return lambda a: a


@overload(lanes.largest_of, jit_options=INLINED, strict=False)
def _largest_of(a: Any) -> Any:
    if isinstance(a, LanesType):
        return lambda a: max(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7])
    return lambda a: a


# ---- arrays --------------------------------------------------------------------------------------------------


def _row_address(context: Any, builder: Any, rows_type: Any, rows: Any, row: Any, start: Any) -> Any:
    """Address of ``rows[row, start]`` of a C-contiguous array, as that of a vector."""
    array = context.make_array(rows_type)(context, builder, rows)
    width = builder.extract_value(array.shape, 1)
    position = builder.add(builder.mul(row, width), start)
    return builder.bitcast(builder.gep(array.data, [position]), VECTOR.as_pointer())


@intrinsic
def _load_lanes(context: Any, rows: Any, row: Any, start: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_row_address(context, builder, signature.args[0], *args), align=8)

    return lanes_type(rows, types.uintp, types.uintp), generate


@intrinsic
def _store_lanes(context: Any, rows: Any, row: Any, start: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[3], _row_address(context, builder, signature.args[0], *args[:3]), align=8)
        return context.get_dummy_value()

    return types.void(rows, types.uintp, types.uintp, lanes_type), generate


@overload(lanes.lanes_at, jit_options=INLINED, strict=False)
def _lanes_at(rows: Any, row: Any, start: Any) -> Any:
    return lambda rows, row, start: _load_lanes(rows, row, start)


@overload(lanes.put_lanes, jit_options=INLINED, strict=False)
def _put_lanes(rows: Any, row: Any, start: Any, lanes: Any) -> Any:
    return lambda rows, row, start, lanes: _store_lanes(rows, row, start, lanes)


@type_callable(Eight)
def _type_eight(context: Any) -> Callable[..., Any]:
    return lambda first: eight_type if isinstance(first, types.Integer) else None


@type_callable(UpToEight)
def _type_up_to_eight(context: Any) -> Callable[..., Any]:
    def typer(first: Any, last: Any) -> Any:
        return up_to_eight_type if all(isinstance(t, types.Integer) for t in (first, last)) else None

    return typer


@lower_builtin(Eight, types.Integer)
def _make_eight(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    proxy = cgutils.create_struct_proxy(eight_type)(context, builder)
    proxy.first = context.cast(builder, args[0], sig.args[0], types.uintp)
    return proxy._getvalue()


@lower_builtin(UpToEight, types.Integer, types.Integer)
def _make_up_to_eight(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    proxy = cgutils.create_struct_proxy(up_to_eight_type)(context, builder)
    proxy.first, proxy.last = (
        context.cast(builder, value, given, types.intp) for value, given in zip(args, sig.args, strict=True)
    )
    return proxy._getvalue()


def _particles(context: Any, builder: Any, index_type: Any, index: Any) -> list[Any]:
    """The numbers of eight particles."""
    places = cgutils.create_struct_proxy(index_type)(context, builder, value=index)
    numbers = [builder.add(places.first, I64(k)) for k in range(WIDTH)]
    if isinstance(index_type, EightType):
        return numbers
    inside = [builder.icmp_signed("<", number, places.last) for number in numbers]
    return [builder.select(*choice, places.last) for choice in zip(inside, numbers, strict=True)]


def _elements(context: Any, builder: Any, types_of: Any, array: Any, index: Any, offset: Any) -> list[Any]:
    """Addresses of the same element of eight particles in a C-contiguous array (n, ...)."""
    array_type, index_type = types_of[:2]
    view = context.make_array(array_type)(context, builder, array)
    stride: Any = I64(1)
    for axis in range(1, array_type.ndim):
        stride = builder.mul(stride, builder.extract_value(view.shape, axis))
    particles = _particles(context, builder, index_type, index)
    return [builder.gep(view.data, [builder.add(builder.mul(p, stride), offset)]) for p in particles]


def _is_vector(array_type: Any, index_type: Any) -> bool:
    """Whether the numbers of eight particles lie next to each other in memory."""
    return array_type.ndim == 1 and array_type.dtype == types.float64 and isinstance(index_type, EightType)


@intrinsic
def _load_eight(context: Any, array: Any, index: Any, offset: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        number = signature.args[0].dtype
        places = _elements(context, builder, signature.args, *args)
        if _is_vector(*signature.args[:2]):
            return builder.load(builder.bitcast(places[0], VECTOR.as_pointer()), align=8)
        vector = ir.Constant(VECTOR, ir.Undefined)
        for k, place in enumerate(places):
            value = context.cast(builder, builder.load(place), number, types.float64)
            vector = builder.insert_element(vector, value, I32(k))
        return vector

    return lanes_type(array, index, types.uintp), generate


@intrinsic
def _store_eight(context: Any, array: Any, index: Any, offset: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        number = signature.args[0].dtype
        places = _elements(context, builder, signature.args, *args[:3])
        if _is_vector(*signature.args[:2]):
            builder.store(args[3], builder.bitcast(places[0], VECTOR.as_pointer()), align=8)
            return context.get_dummy_value()
        for k, place in enumerate(places):
            element = builder.extract_element(args[3], I32(k))
            builder.store(context.cast(builder, element, types.float64, number), place)
        return context.get_dummy_value()

    return types.void(array, index, types.uintp, lanes_type), generate


def _place_of_eight(array: Any, index: Any, kinds: Any) -> Any:
    """A function that finds the particles and the offset among a particle's elements; None for other indices."""
    if not isinstance(array, types.Array):
        return None
    if isinstance(index, kinds) and array.ndim == 1:
        return lambda array, index: (index, 0)
    if not (isinstance(index, BaseTuple) and len(index) == array.ndim and isinstance(index[0], kinds)):
        return None
    if array.ndim == 2:
        return lambda array, index: (index[0], index[1])
    return lambda array, index: (index[0], index[1] * array.shape[2] + index[2])


def _place(array: Any, index: Any) -> Any:
    """Found by :func:`_place_of_eight`."""
    raise NotImplementedError


@overload(_place, jit_options=INLINED, strict=False)
def _placed(array: Any, index: Any) -> Any:
    return _place_of_eight(array, index, (EightType, UpToEightType))


@overload(operator.getitem, jit_options=INLINED, strict=False)
def _get_eight(array: Any, index: Any) -> Any:
    if _place_of_eight(array, index, (EightType, UpToEightType)) is None:
        return None

    def load(array: Any, index: Any) -> Any:
        particles, offset = _place(array, index)
        return _load_eight(array, particles, offset)

    return load


@overload(operator.setitem, jit_options=INLINED, strict=False)
def _set_eight(array: Any, index: Any, value: Any) -> Any:
    if _place_of_eight(array, index, EightType) is None:
        return None

    def store(array: Any, index: Any, value: Any) -> None:
        particles, offset = _place(array, index)
        _store_eight(array, particles, offset, value)

    return store
