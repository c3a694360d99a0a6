"""Decks that come with the program, by component: ``inputs/MPM/*.ups``."""
