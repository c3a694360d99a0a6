"""A deck as typed values: the sections of a ``.ups`` file, each declared once."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.cohesive_zones import CohesiveZone
from solver.contact import CONTACT
from solver.creation import GeometryObject
from solver.declare import IntVector, Parameter, SubModel, Vector, one_of
from solver.diffusion import DIFFUSION
from solver.diffusion.interface import DIFFUSION_INTERFACE
from solver.flags import Flags
from solver.geometry.null import Null
from solver.loads import LOAD
from solver.materials import CONSTITUTIVE_MODEL
from solver.materials.constitutive import Material
from solver.materials.damage import DAMAGE, for_constitutive_model
from solver.materials.erosion import EROSION
from solver.time_control import TimeControl
from ups.diagnostics import DeckError, Diagnostics, Fix, did_you_mean
from ups.document import Attribute, Document, Text, read_document
from ups.grammar.components import COMPONENTS
from ups.reader import Opaque, Reader
from ups.rules.old_forms import modernise

if TYPE_CHECKING:
    from ups.result import Result
    from ups.run import Observer


@dataclass(frozen=True)
class Meta:
    """What the deck says of itself."""

    title: Annotated[str, Parameter("what the deck is about")] = ""
    info: Annotated[str, Parameter("more about it")] = ""


@dataclass(frozen=True)
class Component:
    """Which method runs the deck."""

    type: Annotated[str, Parameter("the method", attribute=True)] = ""
    type_tag: Annotated[str, Parameter("the method, in the form of old decks", tag="type")] = ""


@one_of("gravity")
@dataclass(frozen=True)
class PhysicalConstants:
    """Constants of nature, or of the problem."""

    gravity: Annotated[Vector | None, Parameter("acceleration of gravity", unit="m/s^2")] = None
    reference_pressure: Annotated[
        float, Parameter("pressure of the surroundings", unit="Pa", ignored="gas dynamics only")
    ] = 0.0


@dataclass(frozen=True)
class Save:
    """A variable that the archive keeps."""

    label: Annotated[str, Parameter("name of the variable", attribute=True)]
    material: Annotated[
        str, Parameter("materials to keep it for, e.g. 0,2-3; all without", attribute=True)
    ] = ""
    levels: Annotated[str, Parameter("levels to keep it on; all without", attribute=True)] = ""
    compression: Annotated[
        str, Parameter("compression of this variable", choices=("", "none", "gzip"), attribute=True)
    ] = ""
    table_lookup: Annotated[str, Parameter("a table", attribute=True, ignored="combustion only")] = ""


@dataclass(frozen=True)
class Checkpoint:
    """When the whole state is written, so that a run can go on from there."""

    cycle: Annotated[int, Parameter("how many are kept; 0 keeps all", ge=0, attribute=True)] = 2
    interval: Annotated[float, Parameter("time between checkpoints", unit="s", ge=0.0, attribute=True)] = 0.0
    timestepInterval: Annotated[int, Parameter("steps between checkpoints", ge=0, attribute=True)] = 0
    walltimeStart: Annotated[
        int, Parameter("seconds of computing before the first", ge=0, attribute=True)
    ] = 0
    walltimeInterval: Annotated[int, Parameter("seconds of computing between", ge=0, attribute=True)] = 0
    walltimeStartHours: Annotated[float, Parameter("hours before the first", ge=0.0, attribute=True)] = 0.0
    walltimeIntervalHours: Annotated[float, Parameter("hours between", ge=0.0, attribute=True)] = 0.0
    lastTimestep: Annotated[bool, Parameter("write one at the end of the run", attribute=True)] = False


@one_of("outputInterval", "outputTimestepInterval", needed=False)
@dataclass(frozen=True)
class DataArchiver:
    """What is written, where and how often."""

    filebase: Annotated[str, Parameter("name of the archive")]
    outputInterval: Annotated[float | None, Parameter("time between outputs", unit="s", ge=0.0)] = None
    outputTimestepInterval: Annotated[int | None, Parameter("steps between outputs", ge=0)] = None
    outputInitTimestep: Annotated[bool, Parameter("write the state at the start")] = False
    outputLastTimestep: Annotated[bool, Parameter("write the state at the end")] = False
    outputDoubleAsFloat: Annotated[bool, Parameter("write numbers in single precision")] = False
    compression: Annotated[str, Parameter("compression of all variables", choices=("", "none", "gzip"))] = ""
    frequency: Annotated[int, Parameter("steps between rows of the .dat files", ge=1)] = 1
    onTimeStep: Annotated[int, Parameter("which of these steps", ge=0)] = 0
    simTime: Annotated[bool, Parameter("rows of .dat files begin with the time")] = True
    timeStep: Annotated[bool, Parameter("rows of .dat files begin with the step number")] = False
    save: Annotated[tuple[Save, ...], Parameter("a variable to keep")] = ()
    checkpoint: Annotated[Checkpoint | None, Parameter("when to write checkpoints")] = None
    type: Annotated[str, Parameter("format", choices=("UDA", "PIDX", ""), attribute=True)] = ""
    outputFormat: Annotated[str, Parameter("format", choices=("UDA", "PIDX", ""))] = ""


@dataclass(frozen=True)
class BoundaryType:
    """A condition on a face."""

    label: Annotated[
        str, Parameter("what is prescribed: Velocity, Symmetric, Temperature, ...", attribute=True)
    ] = ""
    var: Annotated[
        str,
        Parameter("kind of condition: Dirichlet, Neumann or symmetry", attribute=True),
    ] = ""
    id: Annotated[str, Parameter("material index, or all", attribute=True)] = "all"
    value: Annotated[str, Parameter("the prescribed value: a number or [a, b, c]")] = ""
    functor_name: Annotated[str, Parameter("a function", ignored="combustion only")] = ""


SIDES = ("x-", "x+", "y-", "y+", "z-", "z+", "")
"""The faces of the domain; empty where an attribute does not name one."""


@dataclass(frozen=True)
class Face:
    """A face of the domain, or a part of one, with its conditions."""

    BCType: Annotated[tuple[BoundaryType, ...], Parameter("a condition")] = ()
    side: Annotated[str, Parameter("the whole face: x-, x+, y-, ...", choices=SIDES, attribute=True)] = ""
    circle: Annotated[str, Parameter("a circle of this face", choices=SIDES, attribute=True)] = ""
    annulus: Annotated[str, Parameter("a ring of this face", choices=SIDES, attribute=True)] = ""
    ellipse: Annotated[str, Parameter("an ellipse of this face", choices=SIDES, attribute=True)] = ""
    rectangle: Annotated[str, Parameter("a rectangle of this face", choices=SIDES, attribute=True)] = ""
    rectangulus: Annotated[
        str, Parameter("a rectangular ring of this face", choices=SIDES, attribute=True)
    ] = ""
    origin: Annotated[str, Parameter("centre, three numbers", unit="m", attribute=True)] = ""
    radius: Annotated[float, Parameter("radius of the circle", unit="m", gt=0.0, attribute=True)] = 0.0
    inner_radius: Annotated[float, Parameter("of a ring", unit="m", gt=0.0, attribute=True)] = 0.0
    outer_radius: Annotated[float, Parameter("of a ring", unit="m", gt=0.0, attribute=True)] = 0.0
    minor_radius: Annotated[float, Parameter("of an ellipse", unit="m", gt=0.0, attribute=True)] = 0.0
    major_radius: Annotated[float, Parameter("of an ellipse", unit="m", gt=0.0, attribute=True)] = 0.0
    angle: Annotated[
        float,
        Parameter(
            "of the ellipse's long axis with the first axis of the face", unit="degrees", attribute=True
        ),
    ] = 0.0
    lower: Annotated[str, Parameter("corner of a rectangle, three numbers", unit="m", attribute=True)] = ""
    upper: Annotated[str, Parameter("corner of a rectangle, three numbers", unit="m", attribute=True)] = ""
    inner_lower: Annotated[str, Parameter("corner of the hole", unit="m", attribute=True)] = ""
    inner_upper: Annotated[str, Parameter("corner of the hole", unit="m", attribute=True)] = ""
    outer_lower: Annotated[str, Parameter("corner of the ring", unit="m", attribute=True)] = ""
    outer_upper: Annotated[str, Parameter("corner of the ring", unit="m", attribute=True)] = ""
    name: Annotated[str, Parameter("a name for the reader", attribute=True)] = ""
    type: Annotated[str, Parameter("kind of boundary", attribute=True, ignored="combustion only")] = ""


@dataclass(frozen=True)
class BoundaryConditionSection:
    """Conditions on the faces of the domain."""

    Face: Annotated[tuple[Face, ...], Parameter("a face")] = ()


@dataclass(frozen=True)
class Box:
    """A block of the grid."""

    lower: Annotated[Vector, Parameter("lower corner", unit="m")]
    upper: Annotated[Vector, Parameter("upper corner", unit="m")]
    resolution: Annotated[IntVector | None, Parameter("number of cells in each direction", ge=1)] = None
    patches: Annotated[IntVector, Parameter("number of patches in each direction", ge=1)] = (1, 1, 1)
    extraCells: Annotated[IntVector | None, Parameter("layers of cells around the domain", ge=0)] = None
    periodic: Annotated[IntVector | None, Parameter("1 where the domain repeats", ge=0, le=1)] = None
    spacing: Annotated[Vector | None, Parameter("cell size", unit="m", gt=0.0)] = None
    label: Annotated[str, Parameter("a name for the reader", attribute=True)] = ""


@dataclass(frozen=True)
class Level:
    """A level of the grid: blocks of equal cells."""

    Box: Annotated[tuple[Box, ...], Parameter("a block")]
    spacing: Annotated[Vector | None, Parameter("cell size", unit="m", gt=0.0)] = None
    periodic: Annotated[IntVector | None, Parameter("1 where the domain repeats", ge=0, le=1)] = None
    extraCells: Annotated[IntVector | None, Parameter("layers of cells around the domain", ge=0)] = None
    anchor: Annotated[Vector | None, Parameter("position of node (0, 0, 0)", unit="m")] = None


@dataclass(frozen=True)
class GridSection:
    """The grid and the conditions on its faces."""

    Level: Annotated[tuple[Level, ...], Parameter("a level")]
    BoundaryConditions: Annotated[BoundaryConditionSection, Parameter("conditions on faces")] = field(
        default_factory=BoundaryConditionSection
    )


@dataclass(frozen=True)
class MaterialSection:
    """A material: its constants, how it answers deformation, and the bodies made of it."""

    density: Annotated[float, Parameter("density at the start", unit="kg/m^3", gt=0.0)]
    constitutive_model: Annotated[Any, SubModel(CONSTITUTIVE_MODEL.name)]
    thermal_conductivity: Annotated[float, Parameter("thermal conductivity", unit="W/(m K)", ge=0.0)]
    specific_heat: Annotated[float, Parameter("specific heat at constant volume", unit="J/(kg K)", gt=0.0)]
    geom_object: Annotated[tuple[GeometryObject, ...], Parameter("a body of this material")] = ()
    C_p: Annotated[
        float | None, Parameter("specific heat at constant pressure; default specific_heat", unit="J/(kg K)")
    ] = None
    room_temp: Annotated[float, Parameter("temperature of the surroundings", unit="K", ge=0.0)] = 294.0
    melt_temp: Annotated[float, Parameter("melting temperature", unit="K", gt=0.0)] = 295.0e10
    linear_thermal_expansion_coef: Annotated[
        float, Parameter("coefficient of linear thermal expansion", unit="1/K", ge=0.0)
    ] = 0.0
    is_rigid: Annotated[bool, Parameter("moves as contact tells it, without stress")] = False
    is_active: Annotated[
        bool, Parameter("takes part from the start; if not, from activation_time where it is given")
    ] = True
    activation_time: Annotated[float, Parameter("time from which it takes part", unit="s")] = 0.0
    is_force_transmitting_material: Annotated[bool, Parameter("hands forces on")] = False
    possible_alpha_material: Annotated[
        bool, Parameter("may be the body whose surface separates it from the others in contact")
    ] = True
    damage_model: Annotated[Any, SubModel(DAMAGE.name)] = None
    erosion: Annotated[Any, SubModel(EROSION.name)] = None
    diffusion_model: Annotated[Any, SubModel(DIFFUSION.name)] = None
    do_conc_reduction: Annotated[bool, Parameter("whether its particles count in TotalConc")] = False
    name: Annotated[str, Parameter("name of the material", attribute=True)] = ""

    @property
    def constants(self) -> Material:
        """The constants of the material as its models take them."""
        return Material(
            density=self.density,
            specific_heat=self.specific_heat,
            specific_heat_constant_pressure=self.specific_heat if self.C_p is None else self.C_p,
            thermal_conductivity=self.thermal_conductivity,
            room_temperature=self.room_temp,
            melt_temperature=self.melt_temp,
            thermal_expansion=self.linear_thermal_expansion_coef,
        )

    @property
    def damage(self) -> Any:
        """Its damage model, which decks of old gave inside the constitutive model; None without."""
        return self.damage_model or getattr(self.constitutive_model, "damage_model", None)

    @property
    def waits(self) -> bool:
        """Whether its particles come later: it has no shape, or shapes that hold nothing."""
        return all(isinstance(piece, Null) for body in self.geom_object for piece in body.pieces)

    def of_failed_particles(self) -> MaterialSection:
        """The same material without bodies, for its failed particles to go to."""
        return replace(self, geom_object=(), name=f"{self.name} (failed)".strip())

    def faults(self) -> list[tuple[str, str]]:
        """Models that make no sense together, each with why."""
        try:
            for_constitutive_model(self.damage, self.constitutive_model)
        except ValueError as problem:
            return [("damage_model", str(problem))]
        return []


@dataclass(frozen=True)
class MPMMaterials:
    """Materials and how they touch."""

    material: Annotated[tuple[MaterialSection, ...], Parameter("a material")]
    contact: Annotated[tuple[Any, ...], SubModel(CONTACT.name, many=True)] = ()
    cohesive_zone: Annotated[tuple[CohesiveZone, ...], Parameter("zones that tie materials")] = ()
    diffusion_interface: Annotated[tuple[Any, ...], SubModel(DIFFUSION_INTERFACE.name, many=True)] = ()
    thermal_contact: Annotated[Opaque | None, Parameter("materials exchange heat at nodes they share")] = None


@dataclass(frozen=True)
class MaterialProperties:
    """Materials of each method."""

    MPM: Annotated[MPMMaterials, Parameter("materials of the material point method")]


@dataclass(frozen=True)
class LoadSection:
    """Loads on particles."""

    loads: Annotated[tuple[Any, ...], SubModel(LOAD.name, many=True)] = ()


@dataclass(frozen=True)
class PhysicalBC:
    """Loads of each method."""

    MPM: Annotated[LoadSection, Parameter("loads of the material point method")] = field(
        default_factory=LoadSection
    )


@dataclass(frozen=True)
class Specification:
    """The whole deck for the material point method."""

    Time: Annotated[TimeControl, Parameter("limits of time and time step")]
    Grid: Annotated[GridSection, Parameter("the grid")]
    DataArchiver: Annotated[DataArchiver, Parameter("what is written")]
    MaterialProperties: Annotated[MaterialProperties, Parameter("the materials")]
    MPM: Annotated[Flags, Parameter("options of the material point method")] = field(default_factory=Flags)
    Meta: Annotated[Meta, Parameter("what the deck says of itself")] = field(default_factory=Meta)
    SimulationComponent: Annotated[Component, Parameter("which method runs the deck")] = field(
        default_factory=Component
    )
    PhysicalConstants: Annotated[PhysicalConstants, Parameter("constants")] = field(
        default_factory=PhysicalConstants
    )
    PhysicalBC: Annotated[PhysicalBC, Parameter("loads")] = field(default_factory=PhysicalBC)

    @cached_property
    def materials(self) -> tuple[MaterialSection, ...]:
        """The materials of particles by their indices: the deck's, and those it asks to be made of them.

        With ``create_new_particles`` each is followed by a copy that takes over its failed particles.
        """
        given = self.MaterialProperties.MPM.material
        if not self.MPM.create_new_particles:
            return given
        return tuple(m for section in given for m in (section, section.of_failed_particles()))

    @property
    def conversions(self) -> dict[int, int]:
        """Index of a material -> index of the one that its failed particles are converted into."""
        count = len(self.materials)
        if self.MPM.create_new_particles:
            return {m: m + 1 for m in range(0, count, 2)}
        waiting = next((m for m, section in enumerate(self.materials) if section.waits), None)
        if not self.MPM.manual_new_material or waiting is None:
            return {}
        return {m: waiting for m in range(count) if m != waiting}

    def faults(self) -> list[tuple[str, str]]:
        """Sections that do not go together, each with why."""
        if self.MPM.manual_new_material and not self.conversions:
            message = (
                "manual_new_material needs two materials, of which one waits for the failed particles of the "
                "others with <null/> as the shape of its geom_object"
            )
            return [("MPM", message)]
        return []


@dataclass(frozen=True)
class Deck:
    """A deck that was read: its document, its values, and what there is to say about it.

    ``specification`` is None where the deck has errors, or is for another method.
    """

    path: Path
    document: Document
    specification: Specification | None
    diagnostics: Diagnostics
    reader: Reader

    @property
    def sources(self) -> dict[str, str]:
        """The text of every file of the deck, for showing the lines of diagnostics."""
        return self.document.sources

    def require(self) -> Specification:
        """The values of the deck; raises DeckError where it has errors or asks for what is not supported."""
        for what, at in self.reader.unsupported:
            self.diagnostics.error("UPS412", f"{what}: this program does not run it", at)
        if self.specification is None or self.diagnostics.has_errors:
            raise DeckError(self.diagnostics, self.sources)
        return self.specification

    def run(
        self,
        output: str | os.PathLike[str] | None = None,
        *,
        max_steps: int | None = None,
        threads: int | None = None,
        observers: Iterable[Observer] = (),
    ) -> Result:
        """Run the deck and return its result; see ``ups.session.run_deck``."""
        from ups.session import run_deck

        return run_deck(self, output=output, max_steps=max_steps, threads=threads, observers=observers)


def read_deck(
    path: str | os.PathLike[str],
    *,
    overrides: Iterable[tuple[str, str]] = (),
    text: str | None = None,
    unsaved: Mapping[str, str] | None = None,
) -> Deck:
    """Read a deck with its includes, check it against the declarations, and return it with its diagnostics.

    ``overrides`` are (path of tags, new text) pairs, e.g. ``("Time/maxTime", "1e-3")``. ``text`` and
    ``unsaved`` take the place of what files hold, see ``ups.document.read_document``.
    """
    document = read_document(path, text=text, unsaved=unsaved)
    diagnostics = Diagnostics(document.diagnostics)
    folder = Path(path).parent
    reader = Reader(diagnostics, lambda name: find_data_file(name, folder), document.complete)
    specification = None
    if document.root is not None:
        for override_path, value in overrides:
            _override(document, override_path, value, diagnostics)
        modernise(document.root, diagnostics)
        name = _component(document, diagnostics)
        component = COMPONENTS.get(name)
        if component is not None and component.runs:
            specification = reader.read(Specification, document.root)
        elif component is not None:
            at = document.root.get("SimulationComponent") or document.root
            reader.say_unsupported(f"{name}: {component.meaning}", at)
            reader.runs = False
            if component.record is not None:
                reader.read(component.load(), document.root)
    return Deck(Path(path), document, specification, diagnostics, reader)


def find_data_file(name: str, folder: Path) -> Path:
    """A data file that a deck names: from the working directory, beside the deck, or above it.

    Raises
    ------
    FileNotFoundError
        with the places that were tried.
    """
    program = Path(__file__).resolve().parent.parent
    places = [Path.cwd(), folder, *folder.resolve().parents, program]
    for place in places:
        if (place / name).is_file():
            return place / name
    raise FileNotFoundError(f"data file {name!r} is neither in the working directory nor beside the deck")


def _override(document: Document, path: str, value: str, diagnostics: Diagnostics) -> None:
    """Put a value in the place of a tag's text."""
    assert document.root is not None
    element = document.root.find(path)
    if element is None:
        diagnostics.error("UPS410", f"no <{path}> in the deck to set to {value!r}", document.root)
        return
    element.texts = [Text(value, element.source, element.start, element.open_end)]


def _component(document: Document, diagnostics: Diagnostics) -> str:
    """The method that a deck is for, in lower case; empty after diagnostics where there is none or no such."""
    assert document.root is not None
    section = document.root.get("SimulationComponent")
    if section is None:
        if document.complete:
            message = 'the deck needs <SimulationComponent type="mpm"/>'
            diagnostics.error("UPS101", message, document.root)
        return ""
    at: Attribute | Text | None = section.attributes.get("type")
    child = section.get("type")
    if at is None and child is not None and child.texts:
        at = child.texts[0]
        fix = Fix((section.replaced(f'<SimulationComponent type="{child.text}"/>'),))
        message = "<SimulationComponent><type> is the form of old decks"
        suggestion = f'write <SimulationComponent type="{child.text}"/>'
        diagnostics.note("UPS302", message, child, suggestion, fix)
    if at is None:
        message = "<SimulationComponent> needs the attribute 'type', e.g. \"mpm\""
        diagnostics.error("UPS111", message, section)
        return ""
    name = at.value.strip().lower()
    if name not in COMPONENTS:
        nearest = did_you_mean(name, COMPONENTS)
        suggestion = f"did you mean {nearest}?" if nearest else "this program runs mpm"
        repair = Fix((at.replaced(nearest),), safe=False) if nearest else None
        diagnostics.error("UPS209", f"unknown method {at.value.strip()!r}", at, suggestion, repair)
        return nearest or ""
    return name
