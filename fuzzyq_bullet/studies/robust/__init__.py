"""How planners bear noise, lost readings, errors of the pose, slip and latency."""
