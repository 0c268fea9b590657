"""Who talks to whom: the graph as data, whether it is known, and as a picture."""
