"""Looking into archives: what they hold, whether they are whole, how two differ, values at a place."""
