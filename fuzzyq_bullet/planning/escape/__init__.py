"""Ways out of dead ends: breakout and sustained avoidance, with what was explored so far."""
