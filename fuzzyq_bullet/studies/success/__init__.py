"""How often each planner reaches the goal, by the number of obstacles (Fig. 13)."""
