"""The commands of ``ups``: each module one, a function of the module's name of a few lines that call the library.

Being a module of this package is all that makes a command. ``ups --help`` imports every one of them, so that what a
command needs is imported inside it.
"""
