"""The messages between the notebook and the checker: the channel, and the verdict."""
