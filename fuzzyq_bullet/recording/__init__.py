"""The record of a run, on disk and back, and what can be read from it."""
