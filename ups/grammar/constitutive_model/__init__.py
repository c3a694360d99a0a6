"""Constitutive models of Uintah that this program does not run; each module is one model or close kin."""
