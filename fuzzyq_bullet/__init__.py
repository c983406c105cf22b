"""A differential-drive robot that finds its way among obstacles it has never seen."""

from fuzzyq_bullet.version import __version__

__all__ = ["__version__"]
