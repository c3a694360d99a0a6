"""``ups compare``: two archives, as Uintah's compare_uda does."""

from __future__ import annotations

import sys
from typing import Any

import click

from ups.terminal.ending import FAULT, orderly


class _ExitsWithOne(click.Command):
    """A command whose wrong use leaves with 1, as 2 says something else."""

    def make_context(self, *args: Any, **options: Any) -> click.Context:
        try:
            return super().make_context(*args, **options)
        except click.UsageError as problem:
            problem.show()
            raise click.exceptions.Exit(FAULT) from None


@click.command(cls=_ExitsWithOne)
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
    with orderly():
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
