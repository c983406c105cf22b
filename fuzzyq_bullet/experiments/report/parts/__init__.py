"""The parts of the page, one module each: from sweeps to HTML."""
