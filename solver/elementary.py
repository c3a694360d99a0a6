"""Elementary functions of eight numbers at once, to about the last digit.

Series whose terms beyond the last are below the rounding: nothing is fitted. Kernels take them for those of ``math``
and ``**`` where they are given lanes (``solver.jit`` tells numba so).
"""

from __future__ import annotations

import math

import numpy as np

from solver.dispatch import inline
from solver.lanes import Lanes, anywhere, floor, where

LN_2_HIGH = 0.693147180369123816490
"""The first 32 bits of ln 2: whole numbers below 2^20 times it are exact."""
LN_2_LOW = 1.90821492927058770002e-10
"""What is left."""


def exponent(a: Lanes) -> Lanes:
    """The whole number n of a = m 2^n with 1 <= m < 2, for positive normal numbers."""
    return Lanes(*(np.frexp(a.numbers)[1] - 1.0))


def mantissa(a: Lanes) -> Lanes:
    """The m of a = m 2^n with 1 <= m < 2, for positive normal numbers."""
    return Lanes(*(2.0 * np.frexp(a.numbers)[0]))


def power_of_two(n: Lanes) -> Lanes:
    """2^n for whole numbers between -1022 and 1023."""
    return Lanes(*np.ldexp(1.0, n.numbers.astype(np.int64)))


@inline
def exponential(x: Lanes) -> Lanes:
    """e^x = 2^n e^r with |r| <= ln(2) / 2, the latter by Taylor's series to the 13th power."""
    bounded = where(x > 709.0, 709.0, where(x < -708.0, -708.0, x))
    n = floor(bounded * (1.0 / math.log(2.0)) + 0.5)
    r = (bounded - n * LN_2_HIGH) - n * LN_2_LOW
    r2 = r * r
    r4 = r2 * r2
    low = (1.0 + r) + r2 * (1.0 / 2.0 + r * (1.0 / 6.0))
    middle = (1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0))
    high = (1.0 / 40320.0 + r * (1.0 / 362880.0)) + r2 * (1.0 / 3628800.0 + r * (1.0 / 39916800.0))
    highest = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0)
    series = low + r4 * (middle + r4 * (high + r4 * highest))
    value = series * power_of_two(n)
    return where(x > 709.0, math.inf, where(x < -708.0, 0.0, where(x == x, value, x)))


@inline
def logarithm(x: Lanes) -> Lanes:
    """Ln x = n ln 2 + 2 artanh((m - 1) / (m + 1)) with m within a factor sqrt(2) of 1, by the series of artanh."""
    n = exponent(x)
    m = mantissa(x)
    large = m > math.sqrt(2.0)
    m = where(large, 0.5 * m, m)
    n = where(large, n + 1.0, n)
    f = m - 1.0
    s = f / (2.0 + f)
    z = s * s
    z2 = z * z
    z4 = z2 * z2
    low = (1.0 / 3.0 + z * (1.0 / 5.0)) + z2 * (1.0 / 7.0 + z * (1.0 / 9.0))
    high = (1.0 / 11.0 + z * (1.0 / 13.0)) + z2 * (1.0 / 15.0 + z * (1.0 / 17.0))
    highest = 1.0 / 19.0 + z * (1.0 / 21.0)
    series = z * (low + z4 * (high + z4 * highest))
    # ln m = f - s (f - 2 series): the largest part, f, is exact
    value = n * LN_2_HIGH + (f - (s * (f - 2.0 * series) - n * LN_2_LOW))
    positive = where(x < math.inf, value, x)
    return where(x > 2.3e-308, positive, where(x == x, where(x < 0.0, math.nan, -math.inf), x))


@inline
def power(a: Lanes, b: Lanes | float) -> Lanes:
    """a^b, for a < 0 where b is whole; 0^0 is 1, as everywhere."""
    size = exponential(b * logarithm(abs(a)))
    sign = where(floor(b) == b, where(floor(0.5 * b) == 0.5 * b, 1.0, -1.0), math.nan)
    return where(b == 0.0, 1.0, where(a < 0.0, sign * size, size))


@inline
def small_hyperbolic_sine(x: Lanes) -> Lanes:
    """Sinh x for |x| <= 1, by Taylor's series to the 19th power."""
    z = x * x
    z2 = z * z
    z4 = z2 * z2
    low = (1.0 / 6.0 + z * (1.0 / 120.0)) + z2 * (1.0 / 5040.0 + z * (1.0 / 362880.0))
    high = (1.0 / 39916800.0 + z * (1.0 / 6227020800.0)) + z2 * (
        1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0)
    )
    return x + x * z * (low + z4 * (high + z4 * (1.0 / 121645100408832000.0)))


@inline
def hyperbolic_sine(x: Lanes) -> Lanes:
    """Sinh x, near zero by its series, where the difference of exponentials would lose digits."""
    size = abs(x)
    grown = exponential(size)
    large = 0.5 * (grown - 1.0 / grown)
    return where(size < 1.0, small_hyperbolic_sine(x), where(x < 0.0, -large, large))


@inline
def hyperbolic_cosine(x: Lanes) -> Lanes:
    """Cosh x."""
    grown = exponential(abs(x))
    return 0.5 * (grown + 1.0 / grown)


@inline
def hyperbolic_tangent(x: Lanes) -> Lanes:
    """Tanh x, near zero as sinh x / cosh x with the series of the former."""
    size = abs(x)
    grown = exponential(size)
    large = 1.0 - 2.0 / (grown * grown + 1.0)
    sine = small_hyperbolic_sine(where(size < 1.0, x, 0.0))
    small = sine / (0.5 * (grown + 1.0 / grown))
    return where(size < 1.0, small, where(x < 0.0, -large, large))


LARGEST_ERROR_ARGUMENT = 6.0
"""Beyond it the error function is 1 to rounding."""


@inline
def error_function(x: Lanes) -> Lanes:
    """Erf x = 2 / sqrt(pi) e^(-x^2) sum of 2^n x^(2n + 1) / (1 3 5 ... (2n + 1)), whose terms have one sign."""
    size = where(abs(x) > LARGEST_ERROR_ARGUMENT, LARGEST_ERROR_ARGUMENT, abs(x))
    ratio = 2.0 * size * size
    term = size * exponential(-0.5 * ratio) * (2.0 / math.sqrt(math.pi))
    total = term
    odd = 1.0
    while anywhere(term > 1.0e-17 * total):
        odd += 2.0
        term *= ratio / odd
        total += term
    return where(x < 0.0, -total, total)
