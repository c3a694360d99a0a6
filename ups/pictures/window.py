"""The viewer as a window, where there is a display."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

from ups.pictures.solid import Frame, new_plotter
from ups.pictures.viewer import Viewer

_TICK = 50
"""Milliseconds between looks at what is to be done."""

_SECONDS_BETWEEN_LOOKS = 1.0
"""How often a window looks whether the archive has grown."""

_MOST_BUTTONS = 16
"""Variables, and materials, that there is room for on the left."""

FRAME = Frame(zoom=0.7, shift=(0.0, -0.12), chart=(0.24, 0.16, 0.72, 0.76))
"""Where the picture is among the controls."""

_ROW, _BUTTON = 24, 14
"""Pixels from button to button, and of one."""


def has_display() -> bool:
    """Whether a window can be opened here."""
    if sys.platform in ("win32", "darwin"):
        return "SSH_CONNECTION" not in os.environ
    return bool(os.environ.get("DISPLAY"))


def show(make: Callable[..., Viewer], *, title: str, frames_per_second: float) -> None:
    """Open a window and return when it is closed.

    Parameters
    ----------
    make
        Makes the viewer, in the plotter and the frame that it is given.
    title
        Title of the window.
    frames_per_second
        How fast it plays.

    Raises
    ------
    ArchiveError
        Where the archive does not hold what is asked for.
    """
    plotter = new_plotter(off_screen=False, title=title)
    try:
        window = Window(make(plotter, frame=FRAME), frames_per_second)
        window.loop()
    finally:
        plotter.close()


class Window:
    """Controls around a picture: variables and materials on the left, time and colours below.

    Keys: space plays and pauses, the arrows left and right go a step, ``c`` and ``a`` let the colours
    cover this step and all steps, ``r`` resets the camera, ``q`` closes the window. What is chosen is drawn
    at the next tick, as controls must not be replaced while they are used.

    Parameters
    ----------
    viewer
        What is shown, in a plotter that is on the screen.
    frames_per_second
        How fast it plays.

    Attributes
    ----------
    playing
        Whether it goes on from step to step.
    """

    def __init__(self, viewer: Viewer, frames_per_second: float) -> None:
        self.viewer = viewer
        self.playing = False
        self._plotter = viewer.plotter
        self._pause = 1.0 / frames_per_second
        self._next_frame = self._next_look = 0.0
        self._stale = False
        self._buttons: tuple[object, ...] = ()
        self._add_controls()
        self._bind_keys()
        self._renew()

    def loop(self) -> None:
        """Show the window until it is closed."""
        interactor = self._plotter.iren
        interactor.add_observer("TimerEvent", lambda *_event: self.tick(time.monotonic()))
        interactor.create_timer(_TICK)
        self._plotter.show(auto_close=False)

    def tick(self, now: float) -> None:
        """Do what is due at a time in seconds: play, follow an archive that grows, draw what was chosen."""
        if self.playing and now >= self._next_frame:
            self._next_frame = now + self._pause
            self.viewer.show_next()
            self._stale = True
        if now >= self._next_look:
            self._next_look = now + _SECONDS_BETWEEN_LOOKS
            self._stale = self.viewer.refresh() or self._stale
        if self._stale:
            self._renew()

    def choose(self, act: Callable[[], None]) -> None:
        """Change what is shown by a call of the viewer."""
        act()
        self._stale = True

    def _play(self, on: bool) -> None:
        self.choose(lambda: setattr(self, "playing", on))

    def _limit(self, is_high: bool, value: float) -> None:
        low, high = (self.viewer.limits[0], value) if is_high else (value, self.viewer.limits[1])
        if low < high:
            self.choose(lambda: self.viewer.set_limits(low, high))

    def _renew(self) -> None:
        """Draw, and let the controls show what is chosen."""
        self._stale = False
        viewer, plotter = self.viewer, self._plotter
        with _rendering_once(plotter):
            viewer.draw()
            choices = (viewer.variables, viewer.variable, viewer.materials, viewer.material)
            if choices != self._buttons:
                self._buttons = choices
                self._add_buttons()
            last = max(len(viewer.timesteps) - 1, 1)
            self._step.set(viewer.position, 0, last)
            low, high = viewer.limits
            least, most = min(low, viewer.covered[0]), max(high, viewer.covered[1])
            self._low.set(low, least, most)
            self._high.set(high, least, most)
            self._check_box.GetRepresentation().SetState(int(self.playing))
            timestep = viewer.timesteps[viewer.position]
            now = viewer.trouble or f"step {timestep.step}, time {timestep.time:.6g} s"
            plotter.add_text(now, position=(14, 6), name="now", font_size=8, color="black")

    def _add_controls(self) -> None:
        """Add what stays: the sliders and the box that plays."""
        with _rendering_once(self._plotter):
            self._step = _Slider(
                self._plotter,
                lambda value: self.choose(lambda: self.viewer.show_position(round(value))),
                ("stored step", "%.0f"),
                (0.20, 0.55),
            )
            self._low, self._high = (
                _Slider(self._plotter, partial(self._limit, title == "to"), (title, "%.4g"), span)
                for title, span in (("colours from", (0.60, 0.77)), ("to", (0.81, 0.98)))
            )
            self._check_box = self._plotter.add_checkbox_button_widget(self._play, position=(14, 30), size=26)
            self._plotter.add_text("play (space)", position=(48, 32), font_size=8, color="black")

    def _add_buttons(self) -> None:
        """Add what depends on the choices: a column of buttons of variables and one of materials above it."""
        viewer = self.viewer
        self._plotter.clear_radio_button_widgets()
        above = self._add_column("variable", viewer.variables, viewer.variable, viewer.show_variable, 110)
        self._add_column("material", viewer.materials, viewer.material, viewer.show_material, above)

    def _add_column(
        self, group: str, names: Sequence[str], chosen: str, choose: Callable[[str], None], bottom: int
    ) -> int:
        """Add a column of buttons of which one is on, its title above; where the next begins."""
        plotter, shown = self._plotter, list(names[:_MOST_BUTTONS])[::-1]
        for row in range(_MOST_BUTTONS):
            height, label = bottom + row * _ROW, f"{group} {row}"
            plotter.remove_actor(label, render=False)
            if row < len(shown):
                name = shown[row]
                plotter.add_radio_button_widget(
                    partial(self.choose, partial(choose, name)),
                    group,
                    value=name == chosen,
                    position=(14, height),
                    size=_BUTTON,
                    border_size=3,
                )
                plotter.add_text(name, position=(38, height - 3), name=label, font_size=7, color="black")
        top = bottom + len(shown) * _ROW
        plotter.add_text(group, position=(14, top), name=group, font_size=8, color="dimgray")
        return top + 2 * _ROW

    def _bind_keys(self) -> None:
        viewer = self.viewer
        keys: dict[str, Callable[[], None]] = {
            "space": lambda: self._play(not self.playing),
            "Right": lambda: self.choose(lambda: viewer.show_position(viewer.position + 1)),
            "Left": lambda: self.choose(lambda: viewer.show_position(viewer.position - 1)),
            "c": lambda: self.choose(viewer.fit_step),
            "a": lambda: self.choose(viewer.fit_all),
        }
        for key, act in keys.items():
            self._plotter.add_key_event(key, act)


class _Slider:
    """A slider whose value and ends may be set without its telling so.

    Parameters
    ----------
    plotter
        Where it is.
    act
        Called with the value where it was moved.
    labels
        Its title, and the format of its value.
    span
        Where it begins and ends, in shares of the width.
    """

    def __init__(
        self,
        plotter: Any,
        act: Callable[[float], None],
        labels: tuple[str, str],
        span: tuple[float, float],
    ) -> None:
        self._silent = True
        title, form = labels

        def moved(value: float) -> None:
            if not self._silent:
                act(value)

        self._shown = plotter.add_slider_widget(
            moved,
            (0.0, 1.0),
            title=title,
            pointa=(span[0], 0.065),
            pointb=(span[1], 0.065),
            color="dimgray",
            title_height=0.018,
            title_color="black",
            fmt=form,
            slider_width=0.02,
            tube_width=0.004,
        ).GetRepresentation()
        self._silent = False

    def set(self, value: float, low: float, high: float) -> None:
        """Set the value and the ends."""
        self._shown.SetMinimumValue(low)
        self._shown.SetMaximumValue(high)
        self._shown.SetValue(value)


@contextmanager
def _rendering_once(plotter: Any) -> Iterator[None]:
    """Render when all is in place, rather than after each part of it."""
    interactor = plotter.iren.interactor
    interactor.EnableRenderOff()
    plotter.suppress_rendering = True
    try:
        yield
    finally:
        plotter.suppress_rendering = False
        interactor.EnableRenderOn()
        plotter.render()
