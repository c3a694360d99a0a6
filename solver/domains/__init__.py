"""A run on several ranks: how the grid is cut into domains, and what neighbours tell each other in a step.

Each rank holds a box of cells, its domain, with the particles in it and the nodes that these reach (the halo).
Nodes near a cut are stored by several ranks. Every sum over particles is added up over the ranks that store a
node, in the same order everywhere, so that all copies hold the same bits; what then happens at the nodes happens
to every copy alike. After a step particles move to the rank of their cell.

``communicator`` passes messages, ``decomposition`` cuts the grid, ``reach`` says how wide the halo is, ``halo`` adds up
shared nodes by messages of ``rows``, ``migration`` moves particles, and ``exchange`` is what a simulation sees of all
that. ``mpi`` alone knows MPI.
"""
