"""Holding scenarios to what they expect, each in a process that may die: ``fuzzyq check``."""
