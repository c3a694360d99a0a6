"""Pictures of archives: a variable at a time step, movies of it, and histories; none needs a display."""
