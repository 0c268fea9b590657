"""Subscriptions that are in no student's way: a hidden node, its threads, raw messages."""
