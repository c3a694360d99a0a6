"""The program ``ups``: its commands are the files of :mod:`ups.commands`, each imported when it is asked for."""

from __future__ import annotations

import atexit
import gc
import importlib
import os
from typing import Any

import click

import ups.commands


class Commands(click.Group):
    """The commands of :mod:`ups.commands`: a module holds the one of its own name."""

    def main(self, *arguments: Any, **options: Any) -> Any:
        """Do what the command line says, and leave with its exit status."""
        _collect_seldom()
        return super().main(*arguments, **options)

    def list_commands(self, context: click.Context) -> list[str]:
        """The names, sorted."""
        files = (file for folder in ups.commands.__path__ for file in os.listdir(folder))
        return sorted(file[:-3] for file in files if file.endswith(".py") and not file.startswith("_"))

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        """The command of this name, or None."""
        if name not in self.list_commands(context):
            return None
        command: click.Command = getattr(importlib.import_module(f"ups.commands.{name}"), name)
        return command


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="ups-mpm", prog_name="ups")
def main() -> None:
    """Read, check and run Uintah .ups decks (material point method)."""


def _collect_seldom() -> None:
    """Look for dead objects in cycles seldom, and not at the exit.

    Nearly all objects are modules and declarations, which live to the end; to look through them as often as Python
    does, and once more when it takes the modules apart, is a third of the time of a short run.
    """
    gc.set_threshold(500_000)
    atexit.register(gc.freeze)


if __name__ == "__main__":
    main()
