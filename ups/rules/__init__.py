"""What can be wrong with a deck beyond its form: each module one rule, whose docstring is its user page.

A rule is a subclass of :class:`Rule`; being defined in a module of this package is all that is needed.
"""

from ups.rules.rule import DeckView, Rule, all_rules

__all__ = ["DeckView", "Rule", "all_rules"]
