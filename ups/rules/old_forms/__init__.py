"""Forms of older versions of Uintah: each module one form, brought up to date in the tree before it is read.

A note says what was old and shows the form of today; its fix makes the same change in the file.
"""

from ups.rules.old_forms.old_form import OldForm, modernise

__all__ = ["OldForm", "modernise"]
