"""The physics: grid, particles, materials, contact, loads and the time step. Knows nothing of XML or files."""
