"""The checks of a machine: each looks at one thing and returns a line of the report."""
