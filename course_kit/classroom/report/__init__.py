"""Points as files and pages: gradebooks, tables, feedback."""
