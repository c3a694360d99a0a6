"""Interfaces of diffusion of Uintah that this program does not run."""
