"""Shapes of Uintah that this program does not fill; each module is one shape or close kin."""
