"""Machine code only of what Python calls: helpers and models are made part of kernels, and need none of their own.

Numba makes it of every function when it has compiled it, and a kernel contains a hundred. Here a function waits until
somebody asks for its address.
"""

from __future__ import annotations

from typing import Any

from solver.jit import cache  # noqa: F401 - imports numba as it should be

# isort: split
from numba.core import codegen


class _Library(codegen.JITCodeLibrary):
    """A function with all that it contains."""

    _waits = False

    def _finalize_final_module(self) -> None:
        """Put off machine code, unless it comes from disk."""
        if self._object_caching_enabled and self._compiled_object:
            super()._finalize_final_module()
        else:
            self._waits = self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """The address of one of its functions; 0 if it has none of that name."""
        self._ensure_finalized()
        if self._waits and any(function.name == name for function in self.get_defined_functions()):
            self._waits = False
            super()._finalize_final_module()
            self._codegen.hand_over_environments(self._final_module)
        return super().get_pointer_to_function(name)


class _Codegen(codegen.JITCPUCodegen):
    """What makes machine code; keeps the environments of functions until a kernel that contains them has some."""

    _library_class = _Library

    def __init__(self, module_name: str) -> None:
        self._environments: dict[str, Any] = {}
        super().__init__(module_name)

    def set_env(self, env_name: str, env: Any) -> None:
        """Let machine code find an environment: what a function knows of Python."""
        self._environments[env_name] = env
        if self._engine.get_global_value_address(env_name):
            super().set_env(env_name, env)

    def hand_over_environments(self, module: Any) -> None:
        """Set the environments that a module has room for."""
        for place in module.global_variables:
            if place.name in self._environments:
                self.set_env(place.name, self._environments[place.name])


codegen.JITCPUCodegen = _Codegen  # before numba makes one, which is when it first types or compiles
