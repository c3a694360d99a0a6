"""Rows of nodal sums in messages: only those of nodes where a rank has something are sent.

A message of one link is: how many nodes, their places in the link, and for each array of sums the rows of these nodes.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from solver.deferred import deferred_kernel

Array = NDArray[Any]


@deferred_kernel
def mark_touched(touched: Array, nodes: Array, marks: Array) -> None:
    """Set ``marks`` (k,) to 1 for the nodes (k,) that are touched (N,), else to 0."""
    for e in range(nodes.shape[0]):
        marks[e] = touched[nodes[e]]


@deferred_kernel
def mark_filled(rows: Array, nodes: Array, marks: Array) -> None:
    """Set ``marks`` (k,) to 1 for the nodes (k,) that have a row (N, components) with a number other than 0."""
    for e in range(nodes.shape[0]):
        for c in range(rows.shape[1]):
            if rows[nodes[e], c] != 0.0:
                marks[e] = 1
                break


@deferred_kernel
def pack_places(marks: Array, places: Array, message: Array, start: int) -> int:
    """Begin the message of a link: number and places of its marked nodes; returns where the rows begin.

    ``places`` (k,) are those of the link's nodes in ``marks``.
    """
    end = start + 1
    for e in range(places.shape[0]):
        if marks[places[e]]:
            message[end] = e
            end += 1
    message[start] = end - start - 1
    return end


@deferred_kernel
def pack_rows(rows: Array, nodes: Array, message: Array, start: int, end: int) -> int:
    """Go on, at ``end``, with the rows (N, components) of the nodes (k,) that a message names at ``start``."""
    for n in range(int(message[start])):
        node = nodes[int(message[start + 1 + n])]
        for c in range(rows.shape[1]):
            message[end] = rows[node, c]
            end += 1
    return end


@deferred_kernel
def touch(touched: Array, nodes: Array, message: Array, start: int) -> None:
    """Touch the nodes that the message of a link names."""
    for n in range(int(message[start])):
        touched[nodes[int(message[start + 1 + n])]] = 1


@deferred_kernel
def add_rows(rows: Array, nodes: Array, message: Array, start: int, end: int) -> int:
    """Add the rows that begin at ``end`` to those of the nodes that a message names at ``start``; returns their end."""
    for n in range(int(message[start])):
        node = nodes[int(message[start + 1 + n])]
        for c in range(rows.shape[1]):
            rows[node, c] += message[end]
            end += 1
    return end


@deferred_kernel
def take_out(rows: Array, nodes: Array, marks: Array, own: Array) -> None:
    """Move the rows of marked nodes to ``own`` (k, components), and leave 0."""
    for e in range(nodes.shape[0]):
        if marks[e]:
            for c in range(rows.shape[1]):
                own[e, c] = rows[nodes[e], c]
                rows[nodes[e], c] = 0.0


@deferred_kernel
def add_own(rows: Array, nodes: Array, places: Array, marks: Array, own: Array) -> None:
    """Add rows taken out at ``places`` (k,), where these are marked, to those of nodes (k,)."""
    for e in range(nodes.shape[0]):
        if marks[places[e]]:
            for c in range(rows.shape[1]):
                rows[nodes[e], c] += own[places[e], c]


@deferred_kernel
def touch_own(touched: Array, nodes: Array, places: Array, marks: Array) -> None:
    """Touch the nodes (k,) whose ``places`` (k,) are marked."""
    for e in range(nodes.shape[0]):
        if marks[places[e]]:
            touched[nodes[e]] = 1
