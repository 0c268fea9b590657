"""Colcon workspaces: build, source, import, and the packages that chapters share."""
