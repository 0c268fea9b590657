"""Service calls and goals of actions as data and as pictures, from what their ends publish about them."""
