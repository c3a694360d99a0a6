"""Loops over particles in parts of fixed size, so that sums do not depend on how many threads share the work."""

from __future__ import annotations

CHUNK = 1024
"""Particles whose sums are taken together; the sums of chunks are then added in their order."""


def number_of_chunks(particles: int) -> int:
    """How many chunks that many particles make."""
    return -(-particles // CHUNK)
