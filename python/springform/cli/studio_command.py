"""The command that serves the studio and opens the browser."""

from __future__ import annotations

import json
import webbrowser
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from .terminal import Json, say

commands = typer.Typer()


@commands.command(epilog="Example: `springform studio three-cylinders`")
def studio(
    source: Annotated[
        str | None,
        typer.Argument(
            metavar="DESIGN|RUN",
            help="A design file, a scene's name or a run folder; without it, the start page.",
        ),
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            min=0, max=65535, help="Port; 0: any that is free. By default that of last time."
        ),
    ] = None,
    home: Annotated[
        Path | None, typer.Option(help="Folder of the documents; by default your data folder's.")
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the browser.")] = True,
    as_json: Json = False,
) -> None:
    """Pull, cut and grow the net in the browser while it moves; on this machine only."""
    # The server's libraries are not needed by any other command.
    from ..studio.library import Library, default_home  # noqa: PLC0415
    from ..studio.server import serve  # noqa: PLC0415

    library = Library(default_home() if home is None else home)
    document = None if source is None else library.open(source)

    def ready(address: str) -> None:
        address = address if document is None else f"{address}#{document}"
        if as_json:
            print(json.dumps({"address": address, "document": document}), flush=True)
        else:
            print(address, flush=True)
            say("the studio runs until Ctrl+C; every action is kept at once")
        if browser:
            webbrowser.open(address)

    # Ctrl+C is how the studio is closed, and nothing is lost by it.
    with suppress(KeyboardInterrupt):
        serve(library, port=port, on_ready=ready)
