"""Loads of Uintah that this program does not apply; each module is one load."""
