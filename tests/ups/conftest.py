"""Makes ``small_decks`` importable from the folders below."""
