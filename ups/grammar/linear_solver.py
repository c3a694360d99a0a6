"""Options of the linear solvers that implicit methods use."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section

_SOLVERS = "SMG PFMG SparseMSG CG PCG ConjugateGradient Hybrid GMRES AMG BoomerAMG FAC"
_PRECONDITIONERS = "None SMG PFMG SparseMSG Jacobi Diagonal AMG BoomerAMG FAC"


def _both_cases(words: str) -> tuple[str, ...]:
    """The words as they are usually written, and in lower case."""
    return tuple(form for word in words.split() for form in dict.fromkeys((word, word.lower())))


class SolverParameters(Section):
    """How a linear system is solved."""

    variable: Annotated[str, Parameter("the unknown that the options are for", attribute=True)] = ""
    solver: Annotated[str, Parameter("the method", choices=_both_cases(_SOLVERS))] = "CG"
    preconditioner: Annotated[str, Parameter("the preconditioner", choices=_both_cases(_PRECONDITIONERS))] = (
        "None"
    )
    tolerance: Annotated[float, Parameter("residual at which the iteration ends", ge=0.0)] = 1.0e-8
    initial_tolerance: Annotated[float, Parameter("residual below which nothing is solved", ge=0.0)] = 1.0e-15
    maxiterations: Annotated[int, Parameter("greatest number of iterations", ge=0)] = 75
    norm: Annotated[str, Parameter("norm of the residual", choices=_both_cases("LInfinity L1 L2"))] = "L2"
    criteria: Annotated[
        str, Parameter("what the tolerance refers to", choices=_both_cases("Absolute Relative"))
    ] = "Relative"
    npre: Annotated[int, Parameter("relaxations before coarsening")] = 1
    npost: Annotated[int, Parameter("relaxations after coarsening")] = 1
    skip: Annotated[int, Parameter("leave out relaxations of some levels")] = 0
    jump: Annotated[int, Parameter("levels left out by SparseMSG")] = 0
    relax_type: Annotated[int, Parameter("kind of relaxation", ge=0, le=3)] = 1
    logging: Annotated[int, Parameter("how much the solver prints", ge=0)] = 0
    outputEquations: Annotated[bool, Parameter("write the system to files")] = False
    precond_maxiters: Annotated[int, Parameter("iterations of the preconditioner", ge=0)] = 1
    precond_tolerance: Annotated[float, Parameter("tolerance of the preconditioner")] = 0.0
    setupFrequency: Annotated[int, Parameter("steps between set-ups of the solver")] = 1
    solveFrequency: Annotated[int, Parameter("steps between solutions")] = 1
    updateCoefFrequency: Annotated[int, Parameter("steps between updates of the matrix")] = 1


class LinearSolver(Section):
    """The linear solver of the deck."""

    type: Annotated[
        str, Parameter("library of the solver", choices=("CGSolver", "hypre", "hypreamr"), attribute=True)
    ]
    Parameters: Annotated[SolverParameters | None, Parameter("its options")] = None
