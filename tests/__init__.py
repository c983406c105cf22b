"""The tests, in the same rooms as the package; ``extend`` has those of ``examples/extend``."""
