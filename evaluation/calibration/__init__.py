"""Turns the thesis's two sensor experiments into the probabilities of its sensor model."""
