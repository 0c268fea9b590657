"""Forms for any interface: its fields and what is typed into them, as messages, as a command and as Python."""
