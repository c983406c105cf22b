"""Whether a planner finds a way wherever there is one: ``fuzzyq bench escape``."""
