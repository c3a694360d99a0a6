"""UPS506."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.rules.bodies import particles_at_most, stable_step
from ups.rules.rule import DeckView, Rule
from ups.sizes import BYTES_A_NODE, BYTES_A_PARTICLE, readable_size, size_of_output

_MANY = 20000
_LARGE = 200.0e9
"""Size of an archive, in bytes."""

_MUCH_MEMORY = 64.0e9


class MuchOutput(Rule):
    """The deck writes very many time steps, a very large archive, or needs very much memory.

    **Why.** Each output is a folder with files of its own; tens of thousands fill disks and slow every tool. What
    one output takes is the number of particles (and, for ``g.`` variables, of nodes) times the numbers of each
    saved variable. The number of particles is estimated from the boxes around the bodies.

    **Example.** ``<maxTime>1</maxTime>`` with ``<outputInterval>1e-6</outputInterval>``

    **Repair.** Write less often, or fewer variables, or ``<outputDoubleAsFloat>true</outputDoubleAsFloat>``;
    against too many particles a coarser grid or a smaller ``<res>``. ``ups plan`` says more exactly what a run takes.
    """

    code = register_code("UPS506", "very much output")
    title = "very much output"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Compare the interval of output with the time of the run, and sizes with those of machines."""
        outputs = self._outputs(deck)
        at = deck.find("DataArchiver/outputInterval") or deck.find("DataArchiver/outputTimestepInterval")
        if at is not None and outputs > _MANY:
            yield self.warning(f"about {outputs:.1e} outputs will be written", at, "write less often")
        particles, nodes = particles_at_most(deck), self._nodes(deck)
        size = outputs * self._size_of_output(deck, particles, nodes)
        if at is not None and size > _LARGE:
            what = f"{outputs:.3g} outputs of {particles:.2g} particles"
            message = f"the archive takes up to {readable_size(size)}: {what}"
            yield self.warning(message, at, "write less often, or save less")
        memory = particles * BYTES_A_PARTICLE + nodes * max(deck.material_count, 1) * BYTES_A_NODE
        grid = deck.find("Grid/Level")
        if grid is not None and memory > _MUCH_MEMORY:
            message = (
                f"{particles:.2g} particles on {nodes:.2g} nodes take up to {readable_size(memory)} of memory"
            )
            yield self.warning(message, grid, "are the cells as small as they were meant to be?")

    def _outputs(self, deck: DeckView) -> float:
        """How many times the archive is written."""
        end, interval = deck.number("Time/maxTime"), deck.number("DataArchiver/outputInterval")
        limit = deck.number("Time/max_Timesteps")
        if end is None:
            return 0.0
        if interval and not limit:
            return end / interval
        every = deck.number("DataArchiver/outputTimestepInterval")
        if not every:
            return 0.0
        step = stable_step(deck) if deck.component == "mpm" else None
        return (limit or (end / step if step else 0.0)) / every

    def _nodes(self, deck: DeckView) -> float:
        domain, total = deck.domain, 1.0
        if domain is None or domain.spacing is None:
            return 0.0
        for low, high, cell in zip(domain.lower, domain.upper, domain.spacing, strict=True):
            total *= (high - low) / cell + 1.0
        return total

    def _size_of_output(self, deck: DeckView, particles: float, nodes: float) -> float:
        saves = (save.attributes.get("label") for save in deck.all("DataArchiver/save"))
        labels = [label.value.strip() for label in saves if label is not None]
        single = deck.switch("DataArchiver/outputDoubleAsFloat")
        return size_of_output(
            labels, {"p.": particles, "g.": nodes * max(deck.material_count, 1)}, single=single
        )
