"""Whether a planner finds a way wherever there is one, and what its time is made of."""
