"""Training of planners: scenarios, rewards, and the learning problem of each planner."""
