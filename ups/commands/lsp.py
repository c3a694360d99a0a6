"""``ups lsp``: an editor is served."""

from __future__ import annotations

import click

from ups.terminal.ending import orderly


@click.command()
def lsp() -> None:
    """Serve an editor: findings, explanations, completion and repairs while typing (on standard in and out)."""
    try:
        import pygls  # noqa: F401 - only to see whether it is there
    except ImportError:
        message = "ups lsp needs pygls, which is not installed: pip install 'ups-mpm[lsp]'"
        raise click.ClickException(message) from None
    with orderly():
        from ups.lsp.server import serve

        serve()
