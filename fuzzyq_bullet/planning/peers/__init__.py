"""Planners of other papers, in the same loop, to compare with; one file each."""
