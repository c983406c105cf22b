"""The 3-D view: the still world once a shot, in every frame the robot and what moves."""
