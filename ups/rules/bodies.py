"""Materials in numbers, as far as a deck says them: wave speed, fastest body, stable step."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ups.element import Element
from ups.rules.rule import DeckView
from ups.values import number, numbers


@dataclass(frozen=True)
class MaterialInNumbers:
    """What can be said of a material before anything moves.

    Attributes
    ----------
    element : the ``<material>``.
    model : the record of its constitutive model.
    density, sound_speed : of the undeformed material.
    speed : of its fastest body at the start.
    temperatures : of its bodies at the start.
    """

    element: Element
    model: Any
    density: float
    sound_speed: float
    speed: float
    temperatures: tuple[float, ...]


def materials_in_numbers(deck: DeckView) -> Iterator[MaterialInNumbers]:
    """The materials of particles whose model and density could be read."""
    for element in deck.particle_materials:
        child, model_element = element.get("density"), element.get("constitutive_model")
        model = deck.record(model_element) if model_element is not None else None
        density = number(child.text) if child is not None else None
        if model is None or density is None or not density > 0.0:
            continue
        bodies = element.all("geom_object")
        temperatures = [number(t.text) for body in bodies if (t := body.get("temperature")) is not None]
        known = tuple(t for t in temperatures if t is not None)
        speeds = [math.hypot(*v) for body in bodies if (v := _velocity(body)) is not None]
        sound = wave_speed(model, density, known[0] if known else 294.0)
        if sound is not None:
            yield MaterialInNumbers(element, model, density, sound, max(speeds, default=0.0), known)


def _velocity(body: Element) -> list[float] | None:
    child = body.get("velocity")
    return numbers(child.text) if child is not None else None


def wave_speed(model: Any, density: float, temperature: float) -> float | None:
    """Speed of sound in an undeformed material; None where the model does not tell."""
    import numpy as np

    from solver.materials.constitutive import initial_sound_speed

    try:
        with np.errstate(all="ignore"):
            speed = float(initial_sound_speed(model, np.array([density]), np.array([temperature])).ravel()[0])
    except (TypeError, ValueError, ArithmeticError, AttributeError, IndexError):
        return None
    return speed if math.isfinite(speed) else None


def stable_step(deck: DeckView) -> float | None:
    """The first stable time step times the deck's multiplier; None where it cannot be told."""
    domain = deck.domain
    found = [m for m in materials_in_numbers(deck) if m.sound_speed > 0.0]
    multiplier = deck.number("Time/timestep_multiplier")
    if domain is None or domain.spacing is None or not found or multiplier is None:
        return None
    return multiplier * min(domain.spacing) / max(m.sound_speed + m.speed for m in found)
