"""Materials and bodies in numbers, as far as a deck says them: boxes, particles, wave speed, stable step."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ups.element import Element
from ups.rules.rule import DeckView
from ups.values import number, numbers

_MOVED_BY_CONTACT = ("rigid", "specified", "specified_velocity", "specified_friction")


@dataclass(frozen=True)
class Body:
    """A body at the start.

    Attributes
    ----------
    element : the ``<geom_object>``.
    lower, upper : the corners of the box that bounds its shapes.
    res : particles in each direction of a cell; None where the deck does not say.
    speed : magnitude of its velocity.
    temperature : None where the deck does not say.
    """

    element: Element
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    res: tuple[float, ...] | None
    speed: float
    temperature: float | None


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


def bodies(deck: DeckView, material: Element) -> Iterator[Body]:
    """The bodies of a material whose shapes have a box that is finite."""
    for element in material.all("geom_object"):
        boxes = [box for shape in element.children if (box := bounding_box(deck.record(shape))) is not None]
        if not boxes:
            continue
        lower = tuple(min(box[0][a] for box in boxes) for a in range(3))
        upper = tuple(max(box[1][a] for box in boxes) for a in range(3))
        yield Body(element, lower, upper, _vector(element, "res"), speed_of(element), temperature_of(element))


def bounding_box(shape: Any) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """The corners of the box around a shape, or None where it has none that is finite and not empty."""
    try:
        lower, upper = shape.bounding_box()
    except (AttributeError, NotImplementedError, ValueError, ArithmeticError, OSError):
        return None
    if not all(low <= high and math.isfinite(high - low) for low, high in zip(lower, upper, strict=True)):
        return None
    return tuple(map(float, lower)), tuple(map(float, upper))


def speed_of(body: Element) -> float:
    """The magnitude of a body's velocity at the start."""
    return math.hypot(*(_vector(body, "velocity") or (0.0,)))


def temperature_of(body: Element) -> float | None:
    """The temperature of a body at the start."""
    child = body.get("temperature")
    return number(child.text) if child is not None else None


def particles_at_most(deck: DeckView) -> float:
    """How many particles there are, if every body fills the box around it."""
    domain, total = deck.domain, 0.0
    if domain is None or domain.spacing is None:
        return 0.0
    for body in (b for material in deck.particle_materials for b in bodies(deck, material)):
        if body.res is None:
            continue
        count = 1.0
        for a in range(3):
            length = min(body.upper[a], domain.upper[a]) - max(body.lower[a], domain.lower[a])
            count *= max(length, 0.0) / domain.spacing[a] * body.res[a]
        total += count
    return total


def is_moved_from_outside(deck: DeckView, material: Element) -> bool:
    """Whether a material moves as something other than its own stress says: a rigid one, or the master of a contact."""
    rigid = material.get("is_rigid")
    model = material.get("constitutive_model")
    kind = model.attributes.get("type") if model is not None else None
    if (rigid is not None and rigid.text == "true") or (kind is not None and kind.value.strip() == "rigid"):
        return True
    index = deck.particle_materials.index(material)
    return any(index in _masters(contact) for contact in deck.all("MaterialProperties/MPM/contact"))


def _masters(contact: Element) -> list[int]:
    """The materials that a contact moves as it is told."""
    kind = contact.get("type")
    if kind is None or kind.text not in _MOVED_BY_CONTACT:
        return []
    given = [
        child for tag in ("master_material", "rigid_material") if (child := contact.get(tag)) is not None
    ]
    found = [number(child.text) for child in given]
    return [int(n) for n in found if n is not None and math.isfinite(n)] if given else [0]


def materials_in_numbers(deck: DeckView) -> Iterator[MaterialInNumbers]:
    """The materials of particles whose model and density could be read."""
    for element in deck.particle_materials:
        child, model_element = element.get("density"), element.get("constitutive_model")
        model = deck.record(model_element) if model_element is not None else None
        density = number(child.text) if child is not None else None
        if model is None or density is None or not density > 0.0:
            continue
        objects = element.all("geom_object")
        known = tuple(t for body in objects if (t := temperature_of(body)) is not None)
        sound = wave_speed(model, density, known[0] if known else 294.0)
        if sound is not None:
            fastest = max(map(speed_of, objects), default=0.0)
            yield MaterialInNumbers(element, model, density, sound, fastest, known)


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


def _vector(element: Element, tag: str) -> tuple[float, ...] | None:
    """The three numbers of a child; None where it has none."""
    child = element.get(tag)
    found = numbers(child.text) if child is not None else None
    return tuple(found) if found is not None and len(found) == 3 else None
