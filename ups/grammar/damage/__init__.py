"""Damage models of Uintah that this program does not run; each module is one model."""
