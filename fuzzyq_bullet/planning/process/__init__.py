"""The planner ``process``: a program of one's own, in any language."""
