"""Random numbers as Uintah draws them, so that a deck's seed gives the same material on every machine.

The generator is that of Musil: twelve lanes of four bits each, every lane a walk through one fixed
permutation of 0..15. Its draws are ordered (each needs the one before), so they are compiled; they are made
once, when particles are created.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.scratch import scratch_numbers

Floats = NDArray[np.float64]

PERMUTATION = (4, 7, 10, 15, 6, 13, 1, 8, 12, 9, 0, 14, 5, 11, 2, 3)
"""The fixed permutation of 0..15 that all lanes walk through."""

LANES = 12
"""Lanes of the generator: twelve hexadecimal digits make one number."""


@dataclass(frozen=True)
class Births:
    """Where the particles of one rank were born, when other ranks make others of the same patches."""

    patch: NDArray[Any]
    """(n,) id of the patch of each."""
    numbers: Callable[[], tuple[NDArray[Any], NDArray[Any]]]
    """Finds how many particles of the material were made before each, in its patch and in all."""

    def __len__(self) -> int:
        return len(self.patch)


def turns(patch: NDArray[Any] | Births) -> Iterator[tuple[int, NDArray[Any], NDArray[Any]]]:
    """For each patch its id, which particles were born there, and the turn of each in the patch."""
    places = patch.patch if isinstance(patch, Births) else patch
    numbers = patch.numbers()[0] if isinstance(patch, Births) else None
    for place in np.unique(places).tolist():
        members = np.flatnonzero(places == place)
        yield place, members, np.arange(members.size) if numbers is None else numbers[members]


def patch_seed(seed: int, patch: int) -> int:
    """The seed of a patch, so that patches do not repeat each other's numbers, as a 32-bit integer."""
    return ((seed + patch // 32 + 1) << (patch % 32)) & 0xFFFFFFFF


def _walk(seed: int, permutation: Any, drawn: Any) -> None:
    """Fill ``drawn`` (m,) with the numbers that follow the first one, which is the same for every seed."""
    last, middle, oldest = (
        scratch_numbers(LANES, np.int64),
        scratch_numbers(LANES, np.int64),
        scratch_numbers(LANES, np.int64),
    )
    for lane in range(LANES):
        last[lane] = middle[lane] = oldest[lane] = 0
    for lane in range(4, LANES):
        middle[lane] = (seed >> (4 * (LANES - 1 - lane))) & 15
    place = 4
    for draw in range(-1, drawn.size):
        number = 0.0
        weight = 0.0625
        for lane in range(LANES):
            stride = middle[lane] + last[lane]
            place = (place + 20 + (-stride if oldest[lane] & 1 else stride)) & 15
            oldest[lane], middle[lane], last[lane] = middle[lane], last[lane], permutation[place]
            number += last[lane] * weight
            weight *= 0.0625
        if draw >= 0:
            drawn[draw] = number


@cache
def _compiled_walk() -> Callable[[int, Any, Any], None]:
    from solver.jit import kernel

    return kernel(_walk)


def musil(seed: int, count: int) -> Floats:
    """``count`` numbers of [0, 1) from Musil's generator, multiples of 16^-12, shape (count,)."""
    drawn = np.empty(count)
    _compiled_walk()(seed, np.array(PERMUTATION, np.int64), drawn)
    return drawn


def by_patch(patch: NDArray[Any] | Births, seed: int, per_particle: int = 1) -> Floats:
    """Numbers of [0, 1) for particles, each patch with a generator of its own.

    Parameters
    ----------
    patch : patch id of each particle, (n,); the particles of a patch draw in the order of the array. For a rank
        that has some of them only, its :class:`Births`: it draws for all, and keeps the numbers of its own.
    seed : the seed in the deck.
    per_particle : how many numbers in a row each particle draws.

    Returns
    -------
    The numbers, (n, per_particle).
    """
    drawn = np.empty((len(patch), per_particle))
    for place, members, turn in turns(patch):
        values = musil(patch_seed(seed, place), (int(turn.max()) + 1) * per_particle)
        drawn[members] = values.reshape(-1, per_particle)[turn]
    return drawn


def gaussian(
    pairs: Floats,
    mean: float,
    deviation: float,
    volume: Any = 1.0,
    reference: float = 1.0,
    exponent: float = 1.0,
) -> Floats:
    """Normally distributed values from two uniform draws each, by Box and Muller (1958).

    Parameters
    ----------
    pairs : uniform draws, (n, 2).
    mean, deviation : of the distribution.
    volume, reference, exponent : values are scaled by (reference / volume)^(1 / exponent), larger particles
        being weaker; ``volume`` is a number or (n,).
    """
    normal = np.sqrt(-2.0 * np.log(pairs[:, 0])) * np.cos(2.0 * math.pi * pairs[:, 1])
    return size_effect(volume, reference, exponent) * (normal * deviation + mean)


def weibull(
    draws: Floats,
    mean: float,
    modulus: float,
    volume: Any = 1.0,
    reference: float = 1.0,
    exponent: float = 1.0,
) -> Floats:
    """Values of Weibull's distribution of given mean and modulus from uniform draws (n,).

    The scale parameter is mean / Gamma(1 + 1 / modulus) (Brannon and Strack, Sandia National Laboratories);
    the size effect is that of :func:`gaussian`.
    """
    scale = mean / math.gamma(1.0 / modulus + 1.0)
    return size_effect(volume, reference, exponent) * scale * (-np.log(draws)) ** (1.0 / modulus)


class WeibullLaw(NamedTuple):
    """Weibull's distribution of strength with its size effect."""

    mean: float
    modulus: float
    volume: float
    """To which the mean belongs."""
    seed: int


def weibull_law(text: str) -> WeibullLaw | None:
    """The distribution that a deck writes as "weibull, mean, modulus, reference volume, seed".

    None where the text is empty or a number: one value for all.

    Raises
    ------
    ValueError
        when the text is neither empty, a number, nor the five parts of a Weibull distribution.
    """
    words = [word.strip() for word in text.strip().strip('"').split(",")]
    if not words[0].lower().startswith("weib"):
        if text.strip():
            float(text)
        return None
    if len(words) != 5:
        raise ValueError("a Weibull distribution has four numbers: mean, modulus, reference volume, seed")
    law = WeibullLaw(float(words[1]), float(words[2]), float(words[3]), int(float(words[4])))
    if law.modulus <= 0.0 or law.volume <= 0.0:
        raise ValueError("modulus and reference volume of a Weibull distribution are positive")
    return law


def uniform(draws: Floats, middle: float, spread: float) -> Floats:
    """Values in [middle - spread, middle + spread) from uniform draws of [0, 1)."""
    return middle + (2.0 * draws - 1.0) * spread


def size_effect(volume: Any, reference: float, exponent: float) -> Any:
    """The factor (reference / volume)^(1 / exponent) by which strength depends on a particle's volume."""
    return (reference / volume) ** (1.0 / exponent)


def drand48(count: int) -> Floats:
    """The first ``count`` numbers of POSIX drand48 in a program that never seeds it, (count,).

    X <- 0x5DEECE66D X + 11 modulo 2^48, from X = 0; the sequence is doubled by jumping ahead its own length.
    """
    mask = np.uint64(2**48 - 1)
    numbers = np.empty(count, np.uint64)
    numbers[:1] = 11
    factor, shift, filled = 0x5DEECE66D, 11, 1
    while filled < count:
        ahead = numbers[: min(filled, count - filled)]
        numbers[filled : filled + ahead.size] = (ahead * np.uint64(factor) + np.uint64(shift)) & mask
        factor, shift = factor * factor % 2**48, (factor + 1) * shift % 2**48
        filled *= 2
    return numbers / 2.0**48
