"""All sweeps of a folder as one page that people look at (``fuzzyq report``)."""
