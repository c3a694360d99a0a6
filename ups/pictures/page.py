"""The viewer as a web page, served by trame: pictures are rendered here, so that the browser needs no graphics card."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import Callable
from typing import Any

from ups.archive import ArchiveError
from ups.pictures.solid import new_plotter
from ups.pictures.viewer import Viewer

_SECONDS_BETWEEN_LOOKS = 1.0
"""How often a page looks whether the archive has grown."""


def serve(
    make: Callable[[Any], Viewer], port: int, *, frames_per_second: float, announce: Callable[[str], None]
) -> None:
    """Serve the page until it is interrupted.

    Parameters
    ----------
    make
        Makes the viewer in the plotter that it is given.
    port
        Where to listen, on this machine only; 0 is any free port.
    frames_per_second
        How fast it plays.
    announce
        Called with the address when the page can be opened.

    Raises
    ------
    ArchiveError
        Where trame is not installed, the port is taken, or the archive does not hold what is asked for.
    """
    viewer = make(new_plotter(off_screen=True))
    page = _Page(viewer, _trame_server(viewer), frames_per_second)
    _check_port(viewer, port)
    page.start(port, announce)


def _trame_server(viewer: Viewer) -> Any:
    try:
        import trame.widgets.vtk
        import trame.widgets.vuetify3  # noqa: F401 - it is there
        from trame.app import get_server
    except ImportError:
        raise ArchiveError(
            viewer.view.archive.path,
            "trame, which makes the web page, is not installed",
            advice="pip install 'ups-mpm[view]', or make pictures with ups plot",
        ) from None
    return get_server(client_type="vue3")


def _check_port(viewer: Viewer, port: int) -> None:
    """Make sure that nobody listens there; trame would only log it."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("localhost", port))
        except OSError as error:
            message = f"cannot serve a page on port {port}: {error.strerror}"
            raise ArchiveError(
                viewer.view.archive.path, message, advice="choose another with --port, or 0 for a free one"
            ) from None


class _Page:
    """The controls, which are the state of the server that all open pages share, and the picture."""

    def __init__(self, viewer: Viewer, server: Any, frames_per_second: float) -> None:
        self._viewer = viewer
        self._server = server
        self._pause = 1.0 / frames_per_second
        self._tasks: list[Any] = []
        state = server.state
        state.trame__title = viewer.view.archive.path.resolve().name
        state.playing = False
        state.low_typed = state.high_typed = ""
        self._picture = self._lay_out()
        self._redraw()
        state.change("variable")(self._on_variable)
        state.change("material")(self._on_material)
        state.change("position")(self._on_position)

    def start(self, port: int, announce: Callable[[str], None]) -> None:
        """Serve until interrupted."""

        def ready(**_state: Any) -> None:
            announce(f"http://localhost:{self._server.port}/")
            for loop in (self._play(), self._follow()):
                self._tasks.append(asyncio.get_event_loop().create_task(loop))

        self._server.controller.on_server_ready.add(ready)
        os.environ.setdefault("TRAME_ARGS", "--server")  # the command line is not for trame
        self._server.start(
            port=port, host="localhost", open_browser=False, show_connection_info=False, timeout=0
        )

    def _lay_out(self) -> Any:
        """Lay the page out; its picture."""
        from trame.ui.vuetify3 import VAppLayout
        from trame.widgets import client
        from trame.widgets import vtk as vtk_widgets
        from trame.widgets import vuetify3 as v3

        with VAppLayout(self._server):
            client.Style("html { overflow: hidden !important; }")
            with v3.VAppBar(height=60):
                v3.VAutocomplete(
                    v_model=("variable",), items=("variables",), label="variable", id="variable", **_FIELD
                )
                v3.VSelect(
                    v_model=("material",), items=("materials",), label="material", id="material", **_FIELD
                )
                for end in ("low", "high"):
                    v3.VTextField(
                        v_model=(f"{end}_typed",),
                        placeholder=(end,),
                        persistent_placeholder=True,
                        label=f"{end} end of the colours",
                        id=end,
                        change=self._on_limits,
                        **_FIELD,
                    )
                v3.VBtn("this step", id="fit-step", click=self._on_fit_step, title="colours cover this step")
                v3.VBtn("all steps", id="fit-all", click=self._on_fit_all, title="colours cover all steps")
                v3.VBtn("reset view", id="reset", click=self._on_reset)
            with v3.VMain(), v3.VContainer(fluid=True, classes="pa-0 fill-height"):
                v3.VAlert("{{ trouble }}", v_if=("trouble",), type="warning", density="compact", id="trouble")
                picture = vtk_widgets.VtkRemoteView(
                    self._viewer.plotter.render_window, ref="picture", interactive_ratio=1
                )
            with v3.VFooter(app=True, classes="pa-2"):
                v3.VBtn(
                    "{{ playing ? 'pause' : 'play' }}", id="play", click="playing = !playing", classes="mr-4"
                )
                v3.VSlider(
                    v_model=("position",),
                    min=0,
                    max=("last",),
                    step=1,
                    id="time",
                    hide_details=True,
                    density="compact",
                )
                v3.VLabel("{{ time }}", id="now", classes="ml-4", style="min-width: 16em")
        return picture

    def _redraw(self) -> None:
        """Draw, and tell the page what is shown and what can be chosen now."""
        viewer, state = self._viewer, self._server.state
        viewer.draw()
        low, high = viewer.limits
        timestep = viewer.timesteps[viewer.position]
        state.update(
            {
                "trouble": viewer.trouble,
                "variable": viewer.variable,
                "variables": viewer.variables + viewer.measures,
                "material": viewer.material,
                "materials": viewer.materials,
                "position": viewer.position,
                "last": max(len(viewer.timesteps) - 1, 0),
                "time": f"step {timestep.step}, time {timestep.time:.6g} s",
                "low": f"{low:.6g}",
                "high": f"{high:.6g}",
            }
        )
        self._picture.update()

    def _on_variable(self, variable: str, **_state: Any) -> None:
        if variable and variable != self._viewer.variable:
            self._viewer.show_variable(variable)
            self._forget_typed()
            self._redraw()

    def _on_material(self, material: str, **_state: Any) -> None:
        if material != self._viewer.material:
            self._viewer.show_material(material)
            self._redraw()

    def _on_position(self, position: float, **_state: Any) -> None:
        if int(position) != self._viewer.position:
            self._viewer.show_position(int(position))
            self._redraw()

    def _on_limits(self) -> None:
        state = self._server.state
        try:
            self._viewer.set_limits(
                float(state.low_typed or state.low), float(state.high_typed or state.high)
            )
        except ValueError as problem:
            state.trouble = f"the ends of the colours: {problem}"
            return
        self._redraw()

    def _on_fit_step(self) -> None:
        self._viewer.fit_step()
        self._forget_typed()
        self._redraw()

    def _on_fit_all(self) -> None:
        self._viewer.fit_all()
        self._forget_typed()
        self._redraw()

    def _on_reset(self) -> None:
        self._viewer.reset_camera()
        self._redraw()

    def _forget_typed(self) -> None:
        self._server.state.update({"low_typed": "", "high_typed": ""})

    async def _play(self) -> None:
        """Go on by a step at a time, and from the last to the first, while the page plays."""
        while True:
            await asyncio.sleep(self._pause)
            if self._server.state.playing:
                with self._server.state:
                    self._viewer.show_next()
                    self._redraw()

    async def _follow(self) -> None:
        while True:
            await asyncio.sleep(_SECONDS_BETWEEN_LOOKS)
            if self._viewer.refresh():
                with self._server.state:
                    self._redraw()


_FIELD = {
    "density": "compact",
    "variant": "outlined",
    "hide_details": True,
    "classes": "mx-1",
}
