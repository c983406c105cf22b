"""The version of fuzzyq_bullet, written in every record."""

__version__ = "0.2.0"
