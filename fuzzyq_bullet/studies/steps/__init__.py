"""How many steps each planner takes to the goal among 50 obstacles (Table 5)."""
