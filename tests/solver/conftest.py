"""Puts this folder on the import path of the tests below it, for ``reference`` and ``mpm_cases``."""
