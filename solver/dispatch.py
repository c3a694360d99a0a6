"""Functions whose implementation is chosen by the class of the model they are given.

:func:`generic` declares such a function, :func:`implements` gives it a body for one model, and :func:`inline`
marks a helper that kernels call. None of this imports numba: a deck can be checked without it. When kernels
are needed, ``solver.jit`` hands everything that was declared here to numba, which then specialises each kernel
for the models it is called with, with no branch left in the machine code.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

GENERICS: list[Callable[..., Any]] = []
INLINES: list[Callable[..., Any]] = []
SINGLES: list[Callable[..., Any]] = []
_listeners: list[Callable[[str, Callable[..., Any]], None]] = []


def listen(listener: Callable[[str, Callable[..., Any]], None]) -> None:
    """Call ``listener(kind, function)`` for all that is declared, now and later (used by ``solver.jit``)."""
    _listeners.append(listener)
    for kind, known in (("generic", GENERICS), ("inline", INLINES), ("singly", SINGLES)):
        for function in known:
            listener(kind, function)


def generic(function: Function) -> Function:
    """Declare a function chosen by the class of its first argument; the body given here is only its signature."""
    return _declare(function, None)


def generic_with_default(function: Function) -> Function:
    """As :func:`generic`, with the body given here for models that have none of their own."""
    return _declare(function, function)


def _declare(function: Function, default: Callable[..., Any] | None) -> Function:
    implementations: dict[type, Callable[..., Any]] = {}

    @functools.wraps(
        function, updated=()
    )  # a default that takes lanes does not speak for the bodies of models
    def call(model: Any, *args: Any) -> Any:
        body = implementations.get(type(model), default)
        if body is None:
            raise TypeError(f"{function.__name__} has no implementation for {type(model).__name__}")
        return body(model, *args)

    call.implementations = implementations  # type: ignore[attr-defined]  # functions take attributes
    call.default = default  # type: ignore[attr-defined]  # functions take attributes
    GENERICS.append(call)
    for listener in _listeners:
        listener("generic", call)
    return call  # type: ignore[return-value]  # same signature by wraps


def implements(generic_function: Callable[..., Any], *classes: type) -> Callable[[Function], Function]:
    """Decorator: the body of ``generic_function`` for models of the given class(es)."""

    def register(body: Function) -> Function:
        for cls in classes:
            generic_function.implementations[cls] = body  # type: ignore[attr-defined]  # set by generic
        return body

    return register


def lanewise(body: Function) -> Function:
    """Mark the body of a generic function: it can be given the lanes of eight particles in place of numbers.

    Nothing in it branches on a number of the particle; see ``solver.lanes``. Bodies that are not marked are asked
    for one particle after the other. A generic function that is marked itself has lanes among its arguments
    whatever the body.
    """
    body.lanewise = True  # type: ignore[attr-defined]  # functions take attributes
    return body


def is_lanewise(body: Callable[..., Any] | None) -> bool:
    """Whether a body can be given lanes."""
    return getattr(body, "lanewise", False)


def takes_lanes(generic_function: Callable[..., Any], model: Any) -> bool:
    """Whether the body of a generic function for a model can be given lanes."""
    return is_lanewise(generic_function.implementations.get(type(model)))  # type: ignore[attr-defined]  # set by generic


def inline(function: Function) -> Function:
    """Mark a plain function as callable from kernels, with lanes where it does not branch on them."""
    return _announce("inline", INLINES, function)


def singly(function: Function) -> Function:
    """Mark a plain function as callable from kernels, which ask it for one of eight particles after the other."""
    return _announce("singly", SINGLES, function)


def _announce(kind: str, known: list[Callable[..., Any]], function: Function) -> Function:
    known.append(function)
    for listener in _listeners:
        listener(kind, function)
    return function
