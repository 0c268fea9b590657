"""What the notebooks of the course stand on."""
