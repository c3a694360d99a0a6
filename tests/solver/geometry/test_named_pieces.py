"""Labels that are defined once and used again."""

import pytest

from solver.geometry.box import Box
from solver.geometry.named_pieces import NamedPieces
from solver.geometry.null import Null


def test_a_label_gives_back_its_piece():
    names, box = NamedPieces(), Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), label="block")
    names.define("box", box)
    names.define("null", Null())
    names.define("null", Null())
    assert names.refer("box", "block") is box


def test_what_cannot_be_referred_to():
    names = NamedPieces()
    names.define("null", Null(label="nothing"))
    with pytest.raises(ValueError, match=r"no piece is labelled 'block' .*'nothing'"):
        names.refer("box", "block")
    with pytest.raises(ValueError, match="'nothing' names a <null>, not a <box>"):
        names.refer("box", "nothing")
    with pytest.raises(ValueError, match="already names a piece"):
        names.define("null", Null(label="nothing"))
