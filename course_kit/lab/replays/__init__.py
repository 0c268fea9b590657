"""A bag through a node in step, and two versions of the node compared."""
