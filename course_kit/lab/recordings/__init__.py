"""Topics into memory: recorded, measured, as arrays, over time, as pictures."""
