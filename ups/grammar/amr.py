"""Refinement of the grid in space and time."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import IntVector, Parameter, Section, SectionOf, SubModel, family, model

REGRIDDER = family(
    "regridder", "Regridder", "ups.grammar.amr", "@type", "how the levels of the grid follow the solution"
)


class Threshold(Section):
    """A variable whose gradient asks for refinement."""

    name: Annotated[str, Parameter("label of the variable", attribute=True)]
    value: Annotated[float, Parameter("gradient from which cells are refined", attribute=True)]
    matl: Annotated[str, Parameter("material of the variable", attribute=True)]


class RefinementCriteria(Section):
    """What asks for refinement."""

    Variable: Annotated[tuple[Threshold, ...], Parameter("a variable and its threshold")] = ()


class AmrIce(Section):
    """Refinement in gas dynamics."""

    orderOfInterpolation: Annotated[int, Parameter("order of interpolation between levels", ge=0)]
    orderOf_CFI_Interpolation: Annotated[int, Parameter("the same at the edge of a level", ge=0)] = 0
    do_Refluxing: Annotated[bool, Parameter("make fluxes at the edge of levels conservative")]
    Refinement_Criteria_Thresholds: Annotated[
        RefinementCriteria | None, Parameter("what asks for refinement")
    ] = None
    ClampSpecificVolume: Annotated[bool, Parameter("keep specific volumes positive")] = False


class RefineRegions(Section):
    """Bodies in which the grid is fine."""

    geom_object: Annotated[
        Any, SectionOf("ups.grammar.ice_material:PlainRegion", many=True), Parameter("a body to refine")
    ] = ()


class AmrMpm(Section):
    """Refinement in the material point method."""

    min_grid_level: Annotated[int, Parameter("coarsest level with particles")] = 0
    max_grid_level: Annotated[int, Parameter("finest level with particles")] = 1000
    manualGrid: Annotated[bool, Parameter("take the levels of the deck")] = False
    CFI_interpolator: Annotated[
        str, Parameter("shape functions at the edge of levels", choices=("linear", "gimp"))
    ] = "linear"
    Refine_Regions: Annotated[RefineRegions | None, Parameter("bodies in which the grid is fine")] = None
    Refinement_Criteria_Thresholds: Annotated[
        RefinementCriteria | None, Parameter("what asks for refinement")
    ] = None


class RegridderBase(Section):
    """What both kinds of regridder read."""

    adaptive: Annotated[bool, Parameter("change the levels during the run")] = True
    max_levels: Annotated[int, Parameter("greatest number of levels", ge=0)]
    regrid_once: Annotated[bool, Parameter("refine at the start alone")] = False
    amr_overhead_high: Annotated[
        float, Parameter("share of time above which it refines less", ge=0.0, le=1.0)
    ] = 0.15
    amr_overhead_low: Annotated[
        float, Parameter("share of time below which it refines more", ge=0.0, le=1.0)
    ] = 0.05
    cell_stability_dilation: Annotated[IntVector | None, Parameter("cells of margin for stability", ge=0)] = (
        None
    )
    cell_regrid_dilation: Annotated[
        IntVector | None, Parameter("cells of margin between regriddings", ge=0)
    ] = None
    dynamic_dilation: Annotated[bool, Parameter("fit the margin to the run")] = False
    max_dilation: Annotated[bool, Parameter("use the greatest margin")] = False
    max_timestep_interval: Annotated[int, Parameter("most steps between regriddings")] = 50
    min_timestep_interval: Annotated[int, Parameter("fewest steps between regriddings")] = 1
    min_boundary_cells: Annotated[IntVector | None, Parameter("cells between edges of levels", ge=0)] = None


@model("regridder", "Tiled")
class TiledRegridder(RegridderBase):
    """Levels made of equal tiles."""

    min_patch_size: Annotated[str, Parameter("cells of a tile, one vector for each level")]
    cell_refinement_ratio: Annotated[str, Parameter("cells of the finer level in a coarse one")]
    patches_per_level_per_proc: Annotated[float, Parameter("patches each process gets", ge=0.0)] = 8.0


@model("regridder", "SingleLevel")
class SingleLevelRegridder(RegridderBase):
    """One level whose patches change."""

    new_patch_layout: Annotated[IntVector, Parameter("number of patches in each direction", ge=1)]
    level: Annotated[int, Parameter("the level", ge=0)] = 0


class CoarseFineCondition(Section):
    """How a variable is treated at the edge of a level."""

    id: Annotated[str, Parameter("material index, or all", attribute=True)] = "all"
    var: Annotated[
        str,
        Parameter(
            "the scheme",
            choices=("FC0", "FC0New", "FCSimple", "FCLinear", "FCBilinear", "FC1", "FC1New"),
            attribute=True,
        ),
    ]
    label: Annotated[str, Parameter("label of the variable", attribute=True)]


class CoarseFineInterfaces(Section):
    """How variables are treated at the edges of levels."""

    FCIType: Annotated[tuple[CoarseFineCondition, ...], Parameter("a variable's treatment")] = ()


class Amr(Section):
    """Refinement of the grid."""

    type: Annotated[
        str, Parameter("kind of refinement", choices=("Dynamic", "StaticGridML"), attribute=True)
    ] = ""
    doMultiTaskgraphing: Annotated[bool, Parameter("one task graph a level")] = False
    useLockStep: Annotated[bool, Parameter("one time step for all levels")] = False
    ICE: Annotated[AmrIce | None, Parameter("refinement in gas dynamics")] = None
    MPM: Annotated[AmrMpm | None, Parameter("refinement for particles")] = None
    Regridder: Annotated[Any, SubModel("regridder")] = None
    FineCoarseInterfaces: Annotated[CoarseFineInterfaces | None, Parameter("edges of levels")] = None
