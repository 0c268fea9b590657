"""What nodes log: as it arrives, at which level, in which files."""
