"""What the benchmark measures, each in a process of its own: one program a module, one JSON object a line."""
