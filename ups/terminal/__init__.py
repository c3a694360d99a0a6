"""What commands have in common: how they end, options, and bars."""
