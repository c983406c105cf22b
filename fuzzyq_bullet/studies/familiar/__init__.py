"""What crossing the same field again is worth: ``fuzzyq bench familiar``."""
