"""What the project promises about its own speed, measured: ``fuzzyq bench speed``."""
