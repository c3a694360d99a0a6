"""What a contact law is given, what it may ask for, and the tags that every ``<contact>`` block may hold."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from solver.declare import IntVector, Parameter, Vector
from solver.deferred import directly
from solver.dispatch import inline
from solver.domains.exchange import Exchange, OneRank
from solver.grid import Grid
from solver.nodal import NodalFields
from solver.particles import Particles
from solver.workspace import Workspace

Array = NDArray[Any]
Shared = TypeVar("Shared")

NEGLIGIBLE = 1.0e-14
"""Two numbers of a contact law that differ by no more are equal. Absolute, so it matters in small units."""

PRESENT_MASS = 1.0e-99
"""Nodal mass from which an excluded or a master material counts as present."""


@inline
def same(a: float, b: float) -> bool:
    """Whether two numbers differ by no more than Uintah's absolute tolerance."""
    return abs(a - b) <= NEGLIGIBLE


class BoundaryConditions(Protocol):
    """What contact asks of the grid's boundary conditions."""

    def apply_symmetry(self, vectors: Array, material: int, touched: Array = ...) -> None:
        """Treat nodal vectors (N, 3) of a material in place, as velocities on faces of symmetry are.

        Nodes whose ``touched`` is zero may be left out.
        """


@dataclass
class ContactScene:
    """One time step as contact laws see it; the same object serves both parts of the step."""

    grid: Grid
    nodal: NodalFields
    particles: Sequence[Particles]
    """Per material: its particles at the start of the step."""
    rigid: Sequence[bool]
    """Per material: whether it is rigid."""
    possible_alpha: Sequence[bool]
    """Per material: whether it may be the alpha material of a node (see logistic_regression)."""
    axisymmetric: bool
    colinear_normals: bool
    xpic2: bool
    """Whether velocities go between grid and particles by XPIC of order 2."""
    interpolation: Any
    """The interpolator's record, for kernels that weight particles to nodes."""
    node_to_cell_weight: Array
    """(N,) 1/8, doubled for every symmetry face the node lies on (Uintah's NC_CCweight)."""
    boundary_conditions: BoundaryConditions
    owned_nodes: Array
    """(N,) True where a node belongs to a patch (extra nodes are False, and images where one rank has all)."""
    dt: float
    time: float
    """At the start of the step."""
    exchange: Exchange = None  # type: ignore[assignment]  # made from the grid where it is not given
    """The other ranks: what a law sums over particles has to be added up over them."""
    face_forces: Mapping[str, Vector] = field(default_factory=dict)
    """Force on each face (``xminus``, ...) in the step before, where the deck asks for boundary tractions."""
    reductions: dict[tuple[str, int], Any] = field(default_factory=dict)
    """(label, material or -1) -> value (3,) for .dat files, e.g. RigidReactionForce; laws add to them."""
    node_positions: Array = None  # type: ignore[assignment]  # made from the grid where it is not given
    """(N, 3)"""
    workspace: Workspace = field(default_factory=Workspace)
    """Arrays of nodes and particles that laws fill anew in each step."""
    call: Callable[..., Any] = directly
    """Calls a kernel, given first, with values of types that are the same in all steps."""
    _shared: dict[Callable[..., Any], Any] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        """Without other ranks only periodic images have to be heeded."""
        if self.exchange is None:
            self.exchange = OneRank(self.grid)
        if self.node_positions is None:
            self.node_positions = self.grid.node_positions()

    def velocity(self, part: int) -> Array:
        """The (M, N, 3) velocities that a law changes in part 1 or 2."""
        return self.nodal.velocity if part == 1 else self.nodal.velocity_star

    def once(self, compute: Callable[[ContactScene], Shared]) -> Shared:
        """``compute(scene)``, made when a law first asks for it and kept for the rest of the step."""
        if compute not in self._shared:
            self._shared[compute] = compute(self)
        return self._shared[compute]

    @cached_property
    def cell_volume(self) -> float:
        """Volume of a cell."""
        return self.grid.cell_volume

    def list_of_nodes(self, name: str) -> Array:
        """(N,) integers of the workspace, for the indices of nodes that a kernel chooses."""
        return self.workspace.rows(name, len(self.owned_nodes), np.int64)

    def listed(self, materials: tuple[int, ...]) -> Array:
        """The indices a law acts on, ascending, as an integer array: all of them for an empty list."""
        count = self.nodal.mass.shape[0]
        chosen = sorted({m for m in materials if 0 <= m < count}) if materials else range(count)
        return np.array(chosen, dtype=np.int64)

    def add_reduction(self, label: str, material: int, value: Array) -> None:
        """Add to a reduction of the step; ``material`` -1 is the sum over all."""
        self.reductions[label, material] = self.reductions.get((label, material), 0.0) + value


_OTHER_LAWS = "only other contact laws read it"


@dataclass(kw_only=True)
class ContactLaw(ABC):
    """A contact law of a deck: a record of parameters that can change nodal velocities.

    Laws are applied in deck order, twice a step: part 1 on ``nodal.velocity`` before the forces, part 2 on
    ``nodal.velocity_star`` after them. Here are declared all tags that ``<contact>`` may hold, as without
    effect where it does not matter; a law declares anew those that it reads.
    """

    needs_surface: ClassVar[bool] = False
    """Whether the law needs to know which particles lie on the surface of their body."""

    materials: Annotated[
        tuple[int, ...],
        Parameter("indices, from 0, of the materials that the law acts on; all if not given", ge=0),
    ] = ()
    direction: Annotated[IntVector, Parameter("constrained directions", ignored=_OTHER_LAWS)] = (0, 0, 1)
    volume_constraint: Annotated[float, Parameter("least filling of a node", ignored=_OTHER_LAWS)] = 0.0
    separation_factor: Annotated[float, Parameter("greatest separation", ignored=_OTHER_LAWS)] = 9.9e99
    OneOrTwoStep: Annotated[int, Parameter("parts of the step", ignored=_OTHER_LAWS)] = 2
    ExcludeMaterial: Annotated[int, Parameter("material left alone", ignored=_OTHER_LAWS)] = -999
    stop_time: Annotated[float, Parameter("end of the motion", ignored=_OTHER_LAWS)] = float("inf")
    velocity_after_stop: Annotated[Vector, Parameter("velocity after stop_time", ignored=_OTHER_LAWS)] = (
        0.0,
        0.0,
        0.0,
    )
    filename: Annotated[str, Parameter("file of velocities", ignored=_OTHER_LAWS)] = ""
    condition: Annotated[str, Parameter("face whose force changes the motion", ignored=_OTHER_LAWS)] = ""
    conditionValue: Annotated[float, Parameter("force that changes it", ignored=_OTHER_LAWS)] = 9.0e99
    conditionAction: Annotated[str, Parameter("how it changes", ignored=_OTHER_LAWS)] = ""
    master_material: Annotated[int, Parameter("material that leads", ignored=_OTHER_LAWS)] = 0
    normal_only: Annotated[bool, Parameter("free to slide", ignored=_OTHER_LAWS)] = False
    include_rotation: Annotated[bool, Parameter("motion with rotation", ignored=_OTHER_LAWS)] = False
    rigid_material: Annotated[int, Parameter("rigid material", ignored="master_material replaced it")] = 0
    vel_fields: Annotated[
        tuple[int, ...], Parameter("velocity fields", ignored="materials replaced it; it is not read")
    ] = ()
    colinear_norms: Annotated[
        bool, Parameter("normals in opposite directions", ignored="computeColinearNormals of <MPM> decides")
    ] = True

    @abstractmethod
    def apply(self, part: int, scene: ContactScene) -> None:
        """Change the velocities of part 1 or 2 in place."""

    @property
    def made_rigid(self) -> tuple[int, ...]:
        """Materials that the law takes for rigid whatever their constitutive model."""
        return ()

    @property
    def never_alpha(self) -> tuple[int, ...]:
        """Materials that surface normals of other laws may not point away from."""
        return ()

    def check(self, materials: int) -> None:
        """See that the law fits a deck with this number of materials.

        Raises
        ------
        ValueError : if a material that the law singles out does not exist.
        """
        if self.ExcludeMaterial >= 0:
            check_material("ExcludeMaterial", self.ExcludeMaterial, materials)


def check_material(tag: str, index: int, materials: int) -> None:
    """See that a tag names an existing material.

    Raises
    ------
    ValueError : if it does not; the message names the tag and the legal range.
    """
    if not 0 <= index < materials:
        raise ValueError(f"<{tag}> {index} names no material: the deck has 0 to {materials - 1}")
