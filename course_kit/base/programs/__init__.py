"""Programs as child processes, none of which outlives its kernel, and what each uses of the machine."""
