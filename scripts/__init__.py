"""Turns a command line into runs of the testbed and prints what came out."""
