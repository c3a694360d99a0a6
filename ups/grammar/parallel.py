"""How Uintah shares work among processes, runs its tasks and reports on itself."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import IntVector, Parameter, Section, SectionOf

_QUEUES = (
    "MostChildren LeastChildren MostAllChildren LeastAllChildren MostL2Children LeastL2Children "
    "PatchOrder PatchOrderRandom MostMessages LeastMessages Random FCFS Stack"
)


class LoadBalancer(Section):
    """How patches are shared among processes."""

    type: Annotated[
        str,
        Parameter(
            "the method", choices=("Simple", "SimpleLoadBalancer", "RoundRobin", "DLB", "PLB"), attribute=True
        ),
    ]
    timestepInterval: Annotated[int, Parameter("steps between balancings", ge=0)] = 0
    costAlgorithm: Annotated[
        str, Parameter("how costs are foreseen", choices=("Model", "ModelLS", "Kalman", "Memory"))
    ] = "ModelLS"
    dynamicAlgorithm: Annotated[
        str,
        Parameter(
            "what is balanced",
            choices=("particle3", "patchFactor", "patchFactorParticles", "random", "Zoltan"),
        ),
    ] = "patchFactor"
    doSpaceCurve: Annotated[bool, Parameter("order patches along a space-filling curve")] = True
    hasParticles: Annotated[bool, Parameter("count particles")] = False
    profileTimestepWindow: Annotated[int, Parameter("steps over which costs are averaged", ge=0)] = 10
    gainThreshold: Annotated[float, Parameter("gain from which patches move", ge=0.0, le=1.0)] = 0.05
    levelIndependent: Annotated[bool, Parameter("balance each level for itself")] = True
    outputNthProc: Annotated[int, Parameter("every so many processes one writes", ge=0)] = 1
    zoltanAlgorithm: Annotated[str, Parameter("Zoltan's method", choices=("HSFC", "RIB", "RCB"))] = "HSFC"
    zoltanIMBTol: Annotated[float, Parameter("imbalance that Zoltan allows", ge=0.0)] = 1.1
    cellCost: Annotated[float, Parameter("cost of a cell", ge=0.0)] = 1.0
    extraCellCost: Annotated[float, Parameter("cost of an extra cell", ge=0.0)] = 1.0
    particleCost: Annotated[float, Parameter("cost of a particle", ge=0.0)] = 2.0
    patchCost: Annotated[float, Parameter("cost of a patch", ge=0.0)] = 16.0


class MonitoredTask(Section):
    """A task whose cost is recorded."""

    name: Annotated[str, Parameter("name of the task", attribute=True)]
    attribute: Annotated[
        str, Parameter("what is recorded", choices=("ExecTime", "WaitTime"), attribute=True)
    ] = "ExecTime"


class TaskMonitoring(Section):
    """Which costs are recorded."""

    per_cell: Annotated[bool, Parameter("record costs a cell")] = False
    attribute: Annotated[
        tuple[str, ...],
        Parameter("a cost of all tasks", choices=("LoadBalancerCost", "ExecTime", "WaitTime"), repeated=True),
    ] = ()
    task: Annotated[tuple[MonitoredTask, ...], Parameter("a task")] = ()


class TrackedVariable(Section):
    """A variable whose values are printed."""

    label: Annotated[str, Parameter("label of the variable", attribute=True)]
    matl_id: Annotated[int, Parameter("material index", ge=0, attribute=True)] = 0
    dw: Annotated[str, Parameter("store that is looked into", attribute=True)]
    singleTask: Annotated[str, Parameter("the one task around which it is printed", attribute=True)] = ""


class TrackerOutput(Section):
    """Form of the printed numbers."""

    formatFlag: Annotated[str, Parameter("fixed or scientific", attribute=True)]
    precision: Annotated[int, Parameter("digits", ge=0, attribute=True)]


class TrackerLocations(Section):
    """When values are printed."""

    before_comm: Annotated[bool, Parameter("before communication", attribute=True)] = False
    before_exec: Annotated[bool, Parameter("before the task", attribute=True)] = False
    after_exec: Annotated[bool, Parameter("after the task", attribute=True)] = False


class VarTracker(Section):
    """Values that are printed around tasks."""

    start_time: Annotated[float, Parameter("time of the first print", unit="s", ge=0.0)]
    end_time: Annotated[float, Parameter("time of the last print", unit="s", ge=0.0)]
    level: Annotated[int, Parameter("level of the grid")] = 0
    start_index: Annotated[IntVector, Parameter("first cell")]
    end_index: Annotated[IntVector, Parameter("last cell")]
    patchid: Annotated[int, Parameter("patch")] = -1
    output: Annotated[TrackerOutput | None, Parameter("form of the numbers")] = None
    var: Annotated[tuple[TrackedVariable, ...], Parameter("a variable")] = ()
    locations: Annotated[TrackerLocations | None, Parameter("when values are printed")] = None
    task: Annotated[Any, SectionOf("ups.grammar.parallel:MonitoredTask", many=True), Parameter("a task")] = ()


class Scheduler(Section):
    """How tasks are run."""

    type: Annotated[
        str,
        Parameter(
            "the scheduler",
            choices=("MPI", "DynamicMPI", "Unified", "KokkosOpenMP", "Kokkos"),
            attribute=True,
        ),
    ] = "MPI"
    small_messages: Annotated[bool, Parameter("send each variable by itself")] = True
    taskReadyQueueAlg: Annotated[str, Parameter("which task is run next", choices=tuple(_QUEUES.split()))] = (
        "MostMessages"
    )
    TaskMonitoring: Annotated[
        Any, SectionOf("ups.grammar.parallel:TaskMonitoring"), Parameter("which costs are recorded")
    ] = None
    VarTracker: Annotated[
        Any, SectionOf("ups.grammar.parallel:VarTracker"), Parameter("values that are printed")
    ] = None


class RuntimeStatistics(Section):
    """How often statistics are printed."""

    frequency: Annotated[int, Parameter("steps between prints", ge=0)] = 1
    onTimeStep: Annotated[int, Parameter("which of these steps", ge=0)] = 0


class SimulationController(Section):
    """What the run says of itself."""

    RuntimeStats: Annotated[RuntimeStatistics | None, Parameter("statistics of the run")] = None
