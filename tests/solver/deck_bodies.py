"""A small reader of grids and bodies in decks, so that tests need no other part of the program."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from solver.creation import GeometryObject
from solver.declare import FAMILIES, fields
from solver.grid import Grid, Patch
from solver.materials.constitutive import Material

TRIPLE = {"min", "max", "bottom", "top", "origin", "center", "v1", "v2", "v3", "p1", "p2", "p3", "p4"}


def numbers(text):
    return tuple(float(word) for word in text.strip().strip("[]").split(","))


def piece_of(element, named, folder):
    cls = FAMILIES["geometry"].models[element.tag]
    label = element.get("label", "")
    if label in named and not len(element):
        return named[label]
    given: dict[str, Any] = {"label": label}
    if element.tag in ("union", "intersection", "difference"):
        given["pieces"] = tuple(piece_of(child, named, folder) for child in element)
    hints = get_type_hints(cls)
    for info in fields(cls):
        text = element.findtext(info.tag) if info.tag else None
        if text is None or info.name in given:
            continue
        if info.tag in TRIPLE:
            given[info.name] = numbers(text)
        elif info.tag == "var":
            given[info.name] = tuple(child.text.strip() for child in element.findall("var"))
        elif hints[info.name] is bool:
            given[info.name] = text.strip() == "true"
        else:
            given[info.name] = hints[info.name](text.strip())
    piece = cls(**given)
    if hasattr(piece, "load"):
        piece = piece.load(lambda name: folder / name)
    if label:
        named[label] = piece
    return piece


def grid_of(root):
    box = root.find("Grid/Level/Box")
    lower, upper = (np.array(numbers(box.findtext(tag))) for tag in ("lower", "upper"))
    spacing_text = root.findtext("Grid/Level/spacing") or box.findtext("spacing")
    resolution = box.findtext("resolution")
    if resolution:
        cells = np.array(numbers(resolution)).astype(int)
        spacing = (upper - lower) / cells
    else:
        spacing = np.array(numbers(spacing_text))
        cells = np.rint((upper - lower) / spacing).astype(int)
    counts = np.array(numbers(box.findtext("patches") or "[1,1,1]")).astype(int)
    patches = []
    for i, j, k in np.ndindex(*counts):
        low, high = (tuple(int(v) for v in cells * (np.array([i, j, k]) + end) // counts) for end in (0, 1))
        patches.append(Patch(len(patches), low, high))
    extra = tuple(int(v) for v in numbers(box.findtext("extraCells") or "[0,0,0]"))
    return Grid(tuple(lower), tuple(spacing), tuple(int(n) for n in cells), extra, (0, 0, 0), tuple(patches))


def bodies_of(path):
    """The grid, whether it is axisymmetric, and per material its constants and geometry objects."""
    root = ElementTree.parse(path).getroot()
    named: dict[str, Any] = {}
    materials = []
    for element in root.findall("MaterialProperties/MPM/material"):
        objects = [object_of(o, named, Path(path).parent) for o in element.findall("geom_object")]
        density = float(element.findtext("density"))
        materials.append((Material(density, 1.0, 1.0, 1.0, 294.0, 1e9, 0.0), objects))
    axisymmetric = (root.findtext("MPM/axisymmetric") or "false").strip() == "true"
    return grid_of(root), axisymmetric, materials


def object_of(element, named, folder):
    models = FAMILIES["geometry"].models
    given: dict[str, Any] = {
        "pieces": tuple(piece_of(child, named, folder) for child in element if child.tag in models),
        "res": tuple(int(v) for v in numbers(element.findtext("res"))),
        "velocity": numbers(element.findtext("velocity")),
        "temperature": float(element.findtext("temperature")),
    }
    for info in fields(GeometryObject):
        text = element.findtext(info.tag) if info.tag else None
        if text is None or info.name in given:
            continue
        given[info.name] = numbers(text) if "[" in text else info.type(text.strip())
    return GeometryObject(**given)
