"""Robots that learn: tasks to learn on, rewards, and the learning problem of each planner."""
