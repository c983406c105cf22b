"""Experiments over many runs: benchmarks, and the figures and tables of the paper."""
