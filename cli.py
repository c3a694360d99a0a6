"""The program ``ups``: each command a few lines that call the library, imported when it is needed."""

from __future__ import annotations

import atexit
import gc
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from solver.domains.communicator import Communicator
    from ups.archive import ArchiveError
    from ups.deck import Deck
    from ups.diagnostics import DeckError
    from ups.result import Result
    from ups.run import Observer

FAULT, INTERRUPTED = 1, 130
"""Exit statuses: the deck or the data is at fault; Ctrl-C."""


@contextmanager
def _orderly(verbose: bool = False, ranks: Communicator | None = None) -> Iterator[None]:
    """Print diagnostics instead of tracebacks, and leave with the exit status that fits.

    Of several ranks one speaks; where only some failed, the others are ended.
    """
    if ranks is None or ranks.size == 1:
        with _alone_orderly(verbose):
            yield
        return
    try:
        yield
    except BaseException as problem:
        if isinstance(problem, SystemExit):
            raise
        alike = ranks.all_failed()
        if alike and ranks.rank:
            sys.exit(FAULT)
        try:
            with _alone_orderly(verbose):
                raise
        finally:
            if not alike:
                ranks.abort()


@contextmanager
def _alone_orderly(verbose: bool) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read our output has gone; nothing is left to say
        sys.exit(FAULT)
    except Exception as problem:
        _print_known(problem)
        if verbose:
            traceback.print_exc()
        click.echo(
            f"internal error: {type(problem).__name__}: {problem}; please report it with the deck"
            + ("" if verbose else " (run again with -v for details)"),
            err=True,
        )
        sys.exit(FAULT)


def _print_known(problem: Exception) -> None:
    """Print what is wrong with a deck or an archive, and leave; any other exception is not ours to explain."""
    from ups.archive.errors import ArchiveError  # here, as commands that read no archive load none of it
    from ups.diagnostics import DeckError

    if isinstance(problem, ArchiveError):
        problem = _from_archive(problem)
    if isinstance(problem, DeckError):
        _print_error(problem)
        sys.exit(FAULT)


def _from_archive(problem: ArchiveError) -> DeckError:
    from ups.diagnostics import DeckError, Diagnostics

    diagnostics = Diagnostics()
    diagnostics.error("UPS603", f"{problem.path}: {problem.message}", None, problem.advice or None)
    return DeckError(diagnostics)


def _print_error(problem: DeckError) -> None:
    """Errors, on the standard error; warnings and notes were shown before or do not matter now."""
    from ups.diagnostics import Severity

    errors = [d for d in problem.diagnostics if d.severity is Severity.ERROR]
    _print(errors, problem.sources)
    click.echo(f"{len(errors)} error{'s' * (len(errors) != 1)}", err=True)


def _print(diagnostics: Any, sources: Any) -> None:
    from ups.diagnostics_format import render_text

    text = render_text(diagnostics, sources, colour=sys.stderr.isatty())
    if text:
        click.echo(text, err=True)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="ups-mpm", prog_name="ups")
def main() -> None:
    """Read, check and run Uintah .ups decks (material point method)."""


def _overrides(
    context: click.Context, option: click.Parameter, given: tuple[str, ...]
) -> list[tuple[str, str]]:
    pairs = [text.partition("=") for text in given]
    for path, equals, _ in pairs:
        if not equals or not path:
            raise click.BadParameter(f"{path!r} is not of the form PATH=VALUE, such as Time/maxTime=1e-3")
    return [(path.strip("/ "), value) for path, _, value in pairs]


@main.command()
@click.argument("deck", required=False, type=click.Path())
@click.option("--output", type=click.Path(), help="The archive to write; by default <filebase>, numbered.")
@click.option("--restart", type=click.Path(), metavar="ARCHIVE", help="Go on from its checkpoint.")
@click.option("--from", "step", type=click.IntRange(min=0), metavar="STEP", help="That of this step.")
@click.option("--max-steps", type=click.IntRange(min=1), metavar="N", help="Stop after step N.")
@click.option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE", callback=_overrides, help="Set a tag."
)
@click.option(
    "--ranks-per-file", type=click.IntRange(min=1), default=1, metavar="N", help="With mpirun: fewer files."
)
@click.option("--threads", type=click.IntRange(min=1), metavar="N", help="Use N cores; by default all.")
@click.option(
    "--live",
    is_flag=False,
    flag_value="",
    metavar="[VARIABLE]",
    help="Show a variable at each output: a window, or ARCHIVE.png where there is no display.",
)
@click.option("--profile", is_flag=True, help="Print at the end where the time of the steps went.")
@click.option("-q", "--quiet", is_flag=True, help="Print problems only.")
@click.option("-v", "--verbose", is_flag=True, help="Print notes too, and details of internal errors.")
def run(
    deck: str | None,
    output: str | None,
    restart: str | None,
    step: int | None,
    max_steps: int | None,
    overrides: list[tuple[str, str]],
    ranks_per_file: int,
    threads: int | None,
    live: str | None,
    profile: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Run DECK and write its archive, or go on with the run of an ARCHIVE.

    Without --output a restart continues the archive in place. Several processes share the work with
    mpirun -np N ups run ...
    """
    if deck is None and restart is None and live:
        deck, live = live, ""  # `ups run --live DECK`
    if (deck is None) == (restart is None):
        raise click.UsageError("give either a DECK or --restart ARCHIVE")
    if step is not None and restart is None:
        raise click.UsageError("--from belongs to --restart")
    _collect_seldom()
    ranks = _ranks()
    with _orderly(verbose, ranks):
        from ups.deck import read_deck
        from ups.progress import Interrupts, Progress, compilation_notice
        from ups.session import resume_run, run_deck

        quiet = quiet or ranks.rank > 0
        go: Callable[..., Result]
        if restart is not None:
            go = partial(resume_run, restart, step=step, overrides=overrides)
        else:
            loaded = read_deck(str(deck), overrides=overrides)
            if loaded.diagnostics.has_errors:
                loaded.require()  # raises, before anything heavy is imported
            go = partial(run_deck, loaded)
        interrupts = Interrupts()
        observers: list[Observer] = [interrupts] if quiet else [interrupts, Progress()]
        show_warnings = checked = _printer_of_warnings(verbose and not ranks.rank, quiet)
        if live is not None:
            from ups.pictures.live import Live, check_variable
            from ups.pictures.window import has_display

            def checked(deck: Deck) -> None:
                check_variable(deck, live)
                show_warnings(deck)

            if ranks.rank == 0:  # which draws what all have written
                observers.append(Live(live, window=has_display(), stream=None if quiet else sys.stdout))
        if profile:
            from ups.profile import Profile

            observers.append(Profile(sys.stdout if ranks.rank == 0 else None))
        with nullcontext() if quiet else compilation_notice():
            result = go(
                output=output,
                max_steps=max_steps,
                threads=threads,
                ranks_a_file=ranks_per_file,
                observers=observers,
                checked=checked,
                communicator=ranks,
            )
        if received := max(ranks.allgather(interrupts.received)):
            if ranks.rank == 0:
                click.echo(f"go on with: ups run --restart {result.directory}", err=True)
            sys.exit(128 + received)


def _ranks() -> Communicator:
    """The ranks that ``mpirun`` started, or this process alone."""
    from solver.domains.mpi import MissingMpiError, world

    try:
        return world()
    except MissingMpiError as problem:
        click.echo(f"error: {problem}", err=True)
        sys.exit(FAULT)


def _collect_seldom() -> None:
    """Look for dead objects in cycles seldom, and not at the exit.

    Nearly all objects are modules and declarations, which live to the end; to look through them as often as Python
    does, and once more when it takes the modules apart, is a third of the time of a short run.
    """
    gc.set_threshold(100_000)
    atexit.register(gc.freeze)


def _printer_of_warnings(verbose: bool, quiet: bool) -> Callable[[Deck], None]:
    """A function that prints the warnings of a deck, and its notes where they are wanted."""
    from ups.diagnostics import Severity

    shown = {Severity.WARNING, Severity.NOTE} if verbose else set() if quiet else {Severity.WARNING}

    def show(deck: Deck) -> None:
        _print([d for d in deck.diagnostics if d.severity in shown], deck.sources)

    return show


def _say(answer: tuple[str, int]) -> None:
    """Print the text of an answer and leave with its exit status."""
    text, status = answer
    click.echo(text)
    sys.exit(status)


@main.command()
@click.argument("decks", nargs=-1, type=click.Path())
@click.option("--format", "form", type=click.Choice(["text", "json", "github", "sarif"]), default="text")
@click.option("--select", multiple=True, metavar="CODE", help="Only findings whose code begins so.")
@click.option("--ignore", multiple=True, metavar="CODE", help="No findings whose code begins so.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=None,
    help="How many processes share the decks; by default all.",
)
@click.option("--fix", is_flag=True, help="Do the safe repairs in the files that hold the cause.")
@click.option("--unsafe", is_flag=True, help="With --fix or --diff: the other repairs, too.")
@click.option("--diff", is_flag=True, help="Show the repairs, and do none.")
@click.option("--stdin", "from_input", is_flag=True, help="Check the deck on the standard input.")
def lint(decks: tuple[str, ...], from_input: bool, **options: Any) -> None:
    """Check DECKS, files or folders, and report every problem, without running anything.

    Exit status 1 where there is an error; warnings and notes do not count.
    """
    if bool(decks) == from_input and not (from_input and len(decks) == 1):
        raise click.UsageError("give DECKS to check, or --stdin with at most one name for the deck")
    if options["unsafe"] and not (options["fix"] or options["diff"]):
        raise click.UsageError("--unsafe belongs to --fix or --diff")
    with _orderly():
        from ups.lint import LintOptions, lint_command

        text = sys.stdin.read() if from_input else None
        _say(lint_command(decks, LintOptions(colour=sys.stdout.isatty(), **options), text))


@main.command()
def lsp() -> None:
    """Serve an editor: findings, explanations, completion and repairs while typing (on standard in and out)."""
    try:
        import pygls  # noqa: F401 - only to see whether it is there
    except ImportError:
        message = "ups lsp needs pygls, which is not installed: pip install 'ups-mpm[lsp]'"
        raise click.ClickException(message) from None
    with _orderly():
        from ups.lsp.server import serve

        serve()


@main.command()
@click.argument("name")
def explain(name: str) -> None:
    """Explain NAME: a tag, a model, a saved label, or a code such as UPS302."""
    with _orderly():
        from ups.explain import explain_command

        _say(explain_command(name))


@main.command()
@click.argument("deck", type=click.Path())
def plan(deck: str) -> None:
    """Say what a run of DECK would do: materials, particles, steps, memory, archive, time."""
    with _orderly():
        from ups.plan import plan_command

        _say(plan_command(deck))


@main.command()
@click.argument("component", default="")
def schema(component: str) -> None:
    """Write a RELAX NG schema of the deck language, of all of it or of one COMPONENT, for editors."""
    with _orderly():
        from ups.schema import schema_command

        _say(schema_command(component))


@main.command()
@click.argument("first", type=click.Path())
@click.argument("second", type=click.Path())
def diff(first: str, second: str) -> None:
    """Compare the decks FIRST and SECOND by what they mean; exit status 1 where they differ."""
    with _orderly():
        from ups.deck_diff import diff_command

        _say(diff_command(first, second))


@main.command()
@click.argument("deck", type=click.Path())
def expand(deck: str) -> None:
    """Print DECK with its includes in place."""
    with _orderly():
        from ups.deck_diff import expand_command

        _say(expand_command(deck))


def _region(context: click.Context, option: click.Parameter, given: tuple[float, ...] | None) -> Any:
    """The box between two corners, or None."""
    if given is None:
        return None
    from ups.convert.selection import Region

    try:
        return Region((given[0], given[1], given[2]), (given[3], given[4], given[5]))
    except ValueError as problem:
        raise click.BadParameter(str(problem)) from None


@main.command()
@click.argument("archive", type=click.Path())
@click.argument("out", type=click.Path())
@click.option("--variable", "variables", multiple=True, metavar="LABEL", help="Only these variables.")
@click.option("--material", "materials", multiple=True, type=int, metavar="INDEX", help="Only these.")
@click.option("--step", "steps", multiple=True, type=int, metavar="STEP", help="Only these; -1 is the last.")
@click.option("--every", type=click.IntRange(min=1), default=1, metavar="N", help="Only every Nth of them.")
@click.option(
    "--region", type=float, nargs=6, callback=_region, metavar="X Y Z X Y Z", help="Only what is in this box."
)
@click.option(
    "--glyphs", is_flag=True, help="Particles as boxes, deformed as their material is (.pvd, .vtu)."
)
@click.option(
    "--alone", is_flag=True, help="Without the steps of earlier archives that the run went on from."
)
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Threads (VTK XML); one a core.")
def convert(
    archive: str,
    out: str,
    variables: tuple[str, ...],
    materials: tuple[int, ...],
    steps: tuple[int, ...],
    every: int,
    region: Any,
    glyphs: bool,
    alone: bool,
    jobs: int | None,
) -> None:
    """Convert ARCHIVE to OUT, whose suffix chooses the format.

    \b
    name.pvd, folder  series for ParaView: particles, and every level of the grid
    name.vtp .vtu     particles only      name.vti  grid of one level only
    name.vtm          particles and levels as blocks of one data set
    name.vth          levels of the grid as an overlapping hierarchy (AMR)
    name.vtkhdf       all time steps in one file
    name.csv .npz     tables; NumPy arrays
    name.uda          an archive again: fewer steps or variables, several runs in one

    A variable may carry a measure: stress:vonMises, velocity:magnitude, deformationMeasure:strain.
    """  # noqa: D301 - the mark that keeps click from filling the lines below it
    with _orderly():
        from ups.convert import convert as convert_archive

        with _progress_bar("time steps") as progress:
            files = convert_archive(
                archive,
                out,
                variables=variables or None,
                materials=materials or None,
                steps=steps or None,
                every=every,
                region=region,
                glyphs=glyphs,
                alone=alone,
                jobs=jobs,
                progress=progress,
            )
        for path in files:
            click.echo(path)


@main.command()
@click.argument("archive", type=click.Path())
@click.option("--step", type=int, default=-1, metavar="STEP", help="Ranges at this step; -1 is the last.")
@click.option("--json", "as_json", is_flag=True, help="Everything, with each component's range, as JSON.")
def info(archive: str, step: int, as_json: bool) -> None:
    """Show what ARCHIVE holds: steps, grid, variables and their ranges, histories, size, health."""
    with _orderly():
        from ups.inspect.info import render, summarize

        summary = summarize(archive, step)
        if as_json:
            import json

            click.echo(json.dumps(summary.as_dict(), indent=2))
        else:
            click.echo(render(summary))


@main.command()
@click.argument("archive", type=click.Path())
@click.option("--repair", is_flag=True, help="Make it readable up to its last whole step.")
@click.option("--quick", is_flag=True, help="Look at tables and sizes of files only, not at every block.")
def check(archive: str, repair: bool, quick: bool) -> None:
    """Look for what is missing, cut off or damaged in ARCHIVE; exit status 1 where anything is."""
    with _orderly():
        from ups.inspect.check import check_archive, repair_archive

        for action in repair_archive(archive) if repair else []:
            click.echo(action)
        with _progress_bar("time steps") as progress:
            health = check_archive(archive, values=not quick, progress=progress)
        for problem in health.problems:
            click.echo(str(problem))
        click.echo(f"{len(health.whole)} whole time steps, {len(health.damaged)} damaged")
        sys.exit(0 if health.is_sound else FAULT)


class _ExitsWithOne(click.Command):
    """A command whose wrong use leaves with 1, as 2 says something else."""

    def make_context(self, *args: Any, **options: Any) -> click.Context:
        try:
            return super().make_context(*args, **options)
        except click.UsageError as problem:
            problem.show()
            raise click.exceptions.Exit(FAULT) from None


@main.command(cls=_ExitsWithOne)
@click.argument("first", type=click.Path())
@click.argument("second", type=click.Path())
@click.option("--abs-tolerance", type=click.FloatRange(min=0), default=1e-9, show_default=True)
@click.option("--rel-tolerance", type=click.FloatRange(min=0), default=1e-6, show_default=True)
@click.option("--exact", is_flag=True, help="Both tolerances zero.")
@click.option("--variable", "variables", multiple=True, metavar="LABEL", help="Only these variables.")
@click.option("--ignore", multiple=True, metavar="LABEL", help="Not these variables.")
@click.option("--levels", type=int, nargs=2, metavar="I J", help="Only these levels of FIRST and SECOND.")
@click.option("--extra-cells", is_flag=True, help="Compare extra cells, too.")
@click.option("--skip-unknown-types", is_flag=True, help="Pass over variables that cannot be read.")
def compare(
    first: str,
    second: str,
    abs_tolerance: float,
    rel_tolerance: float,
    exact: bool,
    variables: tuple[str, ...],
    ignore: tuple[str, ...],
    levels: tuple[int, int] | None,
    extra_cells: bool,
    skip_unknown_types: bool,
) -> None:
    """Compare the archives FIRST and SECOND as Uintah's compare_uda does.

    A number differs where both tolerances are exceeded. Exit status: 0 equal, 2 tolerances exceeded,
    5 not comparable, 255 type not known, 1 wrong arguments.
    """
    with _orderly():
        from ups.inspect.compare import Tolerances, compare_archives, render

        tolerances = Tolerances(0.0, 0.0) if exact else Tolerances(abs_tolerance, rel_tolerance)
        outcome = compare_archives(
            first,
            second,
            tolerances,
            variables=variables,
            ignore=ignore,
            levels=levels,
            extra_cells=extra_cells,
            skip_unknown_types=skip_unknown_types,
        )
        click.echo(render(outcome))
        sys.exit(outcome.status)


@main.command()
@click.argument("archive", type=click.Path())
@click.argument("variables", nargs=-1, required=True)
@click.option("--point", type=float, nargs=3, metavar="X Y Z", help="At a point.")
@click.option("--line", type=float, nargs=6, metavar="X Y Z X Y Z", help="Along the line between two points.")
@click.option("--particle", type=int, metavar="ID", help="Of the particle of this p.particleID.")
@click.option("--points", type=click.IntRange(min=2), metavar="N", help="Points on the line; one a cell.")
@click.option("--material", type=int, metavar="INDEX", help="Material; 0, or that of the particle.")
@click.option("--level", type=int, metavar="INDEX", help="Level; the finest that holds the place.")
@click.option("--step", "steps", multiple=True, type=int, metavar="STEP", help="Only these; -1 is the last.")
@click.option(
    "--alone", is_flag=True, help="Without the steps of earlier archives that the run went on from."
)
@click.option("-o", "--output", type=click.Path(), help="The .csv to write; by default the terminal.")
def extract(
    archive: str,
    variables: tuple[str, ...],
    point: tuple[float, float, float] | None,
    line: tuple[float, ...] | None,
    particle: int | None,
    points: int | None,
    material: int | None,
    level: int | None,
    steps: tuple[int, ...],
    alone: bool,
    output: str | None,
) -> None:
    """Write values of VARIABLES of ARCHIVE over time as a table: at a point, on a line, of a particle.

    A variable may carry a measure: stress:vonMises, velocity:magnitude, g.stressFS:XY.
    """
    if [point, line, particle].count(None) != 2:
        raise click.UsageError("give one of --point, --line and --particle")
    with _orderly():
        from ups.archive import Archive
        from ups.inspect.extract import extract as extract_table

        ends = None if line is None else ((line[0], line[1], line[2]), (line[3], line[4], line[5]))
        table = extract_table(
            Archive(archive) if alone else Archive(archive).with_earlier_runs(),
            variables,
            point=point,
            line=ends,
            particle=particle,
            count=points,
            material=material,
            level=level,
            steps=steps or None,
        )
        if output is None:
            table.write(sys.stdout)
        else:
            table.save(output)


@main.command()
@click.argument("name", default="")
def materials(name: str) -> None:
    """List the materials that come with the program, or the files and constants of the material NAME."""
    with _orderly():
        from ups.materials import print_catalogue

        print_catalogue(name)


def _turns(context: click.Context, option: click.Parameter, given: str) -> tuple[float, ...]:
    try:
        return tuple(float(word) for word in given.split(","))
    except ValueError:
        raise click.BadParameter(f"{given!r} is neither a strain nor strains with commas between") from None


MODES = ("uniaxial-stress", "uniaxial-strain", "simple-shear", "hydrostatic")


@main.command()
@click.argument("source", metavar="DECK|MATERIAL")
@click.option("--material", type=int, default=0, metavar="INDEX", help="Material of the deck.")
@click.option("--mode", type=click.Choice(MODES), default=MODES[0], show_default=True)
@click.option(
    "--strain",
    default="0.5",
    show_default=True,
    callback=_turns,
    metavar="STRAIN[,STRAIN...]",
    help="At the end, or where the path turns: 0.2,0 unloads. Negative ones compress.",
)
@click.option("--strain-rate", type=float, default=1.0, show_default=True, help="In 1/s.")
@click.option("--temperature", type=float, help="At the start, K; by default the material's room_temp.")
@click.option("--isothermal", is_flag=True, help="Keep the temperature.")
@click.option("--steps", type=click.IntRange(min=1), default=1000, show_default=True)
@click.option("--table", type=click.Path(), help="A file of time and F11 ... F33 in place of a mode.")
@click.option("--flow", help="Flow model of a catalogue material.")
@click.option("--eos", help="Its equation of state.")
@click.option("--shear", help="Its shear modulus model.")
@click.option("--melting", help="Its melting temperature model.")
@click.option("--specific-heat", "specific_heat", help="Its specific heat model.")
@click.option("--csv", "csv_file", type=click.Path(), help="Write all columns there.")
@click.option("--plot", "picture", type=click.Path(), help="Draw a PNG there.")
def point(source: str, csv_file: str | None, picture: str | None, **options: Any) -> None:
    """Take one point of a material along a strain path, without a grid, and print its history."""
    families = ("flow", "eos", "shear", "melting", "specific_heat")
    models = {name: chosen for name in families if (chosen := options.pop(name))}
    with _orderly():
        from ups.point import plot_history, print_history, run_point, write_csv

        history = run_point(source, models=models, **options)
        print_history(history)
        if csv_file is not None:
            write_csv(history, csv_file)
        if picture is not None:
            plot_history(history, picture, source)


def _plane(context: click.Context, option: click.Parameter, given: str | None) -> Any:
    if given is None:
        return None
    from ups.pictures.view import Slice

    try:
        return Slice.parse(given)
    except ValueError as problem:
        raise click.BadParameter(str(problem)) from None


def _step(context: click.Context, option: click.Parameter, given: str) -> int:
    if given == "last":
        return -1
    try:
        return int(given)
    except ValueError:
        raise click.BadParameter(f"{given!r} is neither the number of a step nor 'last'") from None


def _rising(
    context: click.Context, option: click.Parameter, given: tuple[float, float] | None
) -> tuple[float, float] | None:
    if given is not None and not given[0] < given[1]:
        raise click.BadParameter(f"{given[0]:g} is not below {given[1]:g}")
    return given


def _of_pictures(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options that say what a picture shows."""
    for option in reversed(
        (
            click.option("--variable", metavar="LABEL", help="What to show; the stress, or what there is."),
            click.option(
                "--step", default="last", callback=_step, metavar="STEP", help="Time step; the last."
            ),
            click.option("--slice", "plane", callback=_plane, metavar="z=0", help="Cut across an axis."),
            click.option(
                "--material", "materials", multiple=True, type=int, metavar="INDEX", help="Only these."
            ),
            click.option("--level", type=int, default=0, metavar="INDEX", help="Of a grid variable; 0."),
            click.option(
                "--range",
                "limits",
                type=float,
                nargs=2,
                metavar="LOW HIGH",
                callback=_rising,
                help="Of the colours.",
            ),
            click.option(
                "--mirror",
                "mirrored",
                multiple=True,
                type=click.Choice(["x", "y", "z"]),
                callback=lambda _context, _option, given: ["xyz".index(letter) for letter in given],
                help="Add the mirror image in the grid's lower face across this axis.",
            ),
        )
    ):
        command = option(command)
    return command


@main.command()
@click.argument("archive", type=click.Path())
@_of_pictures
@click.option("-o", "--output", type=click.Path(), help="The picture, such as x.png.")
@click.option("--width", type=click.IntRange(100, 10000), metavar="PIXELS", help="Pixels across; about 1000.")
@click.option("--movie", type=click.Path(), help="A movie of all time steps, x.gif or x.mp4.")
@click.option("--fps", type=click.FloatRange(min=0.1), default=10.0, help="Frames of it a second; 10.")
def plot(
    archive: str,
    variable: str | None,
    step: int,
    plane: Any,
    materials: tuple[int, ...],
    level: int,
    limits: tuple[float, float] | None,
    mirrored: list[int],
    output: str | None,
    width: int | None,
    movie: str | None,
    fps: float,
) -> None:
    """Draw a variable of ARCHIVE, such as stress:vonMises, as a picture or a movie; no display is needed."""
    if output is None and movie is None:
        raise click.UsageError("give --output or --movie")
    with _orderly():
        from ups.pictures.movie import movie as make_movie
        from ups.pictures.plot import plot as make_picture

        chosen: dict[str, Any] = {
            "plane": plane,
            "materials": materials or None,
            "level": level,
            "limits": limits,
            "mirrored": mirrored,
            "width": width,
        }
        if output is not None:
            click.echo(make_picture(archive, output, variable, step=step, **chosen))
        if movie is not None:
            with _progress_bar("frames") as progress:
                click.echo(
                    make_movie(archive, movie, variable, frames_per_second=fps, progress=progress, **chosen)
                )


@main.command()
@click.argument("archive", type=click.Path())
@_of_pictures
@click.option("--page", is_flag=True, help="A web page even where there is a display for a window.")
@click.option("--port", type=click.IntRange(0, 65535), default=8080, help="Where it is served; 8080.")
@click.option("--fps", type=click.FloatRange(min=0.1), default=5.0, help="Steps a second when it plays; 5.")
def view(archive: str, page: bool, port: int, fps: float, variable: str | None, **options: Any) -> None:
    """Look at ARCHIVE in a window, or on a web page of this machine where there is no display.

    Time steps, variable, material and colours are chosen there. A run may still be writing the archive.
    """
    with _orderly():
        from pathlib import Path

        from ups.pictures import page as web
        from ups.pictures import window
        from ups.pictures.viewer import Viewer

        options["materials"] = options["materials"] or None
        make = partial(Viewer, archive, variable=variable, **options)
        if page or not window.has_display():
            web.serve(make, port, frames_per_second=fps, announce=_say_address)
        else:
            window.show(make, title=Path(archive).name, frames_per_second=fps)


def _say_address(address: str) -> None:
    click.echo(f"{address} shows the archive; Ctrl-C ends it")


@main.command()
@click.argument("archive", type=click.Path())
@click.argument("histories", nargs=-1)
@click.option("--with", "others", multiple=True, type=click.Path(), metavar="ARCHIVE", help="Its, too.")
@click.option("-o", "--output", type=click.Path(), required=True, help="The picture, such as x.png.")
def history(archive: str, histories: tuple[str, ...], others: tuple[str, ...], output: str) -> None:
    """Draw HISTORIES of ARCHIVE over time, such as KineticEnergy or TotalMomentum:X; without names all."""
    with _orderly():
        from ups.pictures.history import plot_histories

        click.echo(plot_histories(archive, histories, output, others=others))


@contextmanager
def _progress_bar(what: str) -> Iterator[Callable[[int, int], None]]:
    """A bar on the terminal, where there is one, for the library to report to."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(
        *columns, console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()
    ) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


if __name__ == "__main__":
    main()
