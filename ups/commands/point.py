"""``ups point``: one point of a material along a strain path."""

from __future__ import annotations

from typing import Any

import click

from ups.terminal.ending import orderly


def _turns(context: click.Context, option: click.Parameter, given: str) -> tuple[float, ...]:
    try:
        return tuple(float(word) for word in given.split(","))
    except ValueError:
        raise click.BadParameter(f"{given!r} is neither a strain nor strains with commas between") from None


MODES = ("uniaxial-stress", "uniaxial-strain", "simple-shear", "hydrostatic")


@click.command()
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
    with orderly():
        from ups.point import plot_history, print_history, run_point, write_csv

        history = run_point(source, models=models, **options)
        print_history(history)
        if csv_file is not None:
            write_csv(history, csv_file)
        if picture is not None:
            plot_history(history, picture, source)
