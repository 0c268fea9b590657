"""What watches topics without being in a student's way: a hidden node, its threads, raw subscriptions."""
