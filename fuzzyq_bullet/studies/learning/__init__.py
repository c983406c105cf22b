"""What learning gains: learned weights beside fixed ones, on environments no training saw."""
