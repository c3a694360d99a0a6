"""What can be wrong with a deck beyond its form: each module one rule, whose docstring is its user page.

A rule is a subclass of :class:`ups.rules.rule.Rule`; being defined in a module of this package is all that is
needed.
"""
