"""Any field of any message over time: as arrays, as CSV, as a picture."""
