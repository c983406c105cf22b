"""Sweeps: many episodes over all cores, that may be ended at any moment and go on later."""
