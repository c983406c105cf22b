#!/usr/bin/env python3
"""A controller that steers to the clearest direction near the goal's; standard library alone."""

import json
import math
import sys

ROOM = 0.45  # distance (m) at which something ahead begins to slow the robot
BESIDE = 0.9  # distance (m) from the robot's side within which a direction is the worse for it


def main() -> None:
    """Answer every line until there are no more."""
    greeting = json.loads(sys.stdin.readline())
    robot, angles = greeting["robot"], greeting["rays"]
    wide = robot["radius"] + BESIDE
    for line in sys.stdin:
        seen = json.loads(line)
        x, y = seen["position"]
        gx, gy = seen["goal"]
        bearing = math.remainder(math.atan2(gy - y, gx - x) - seen["heading"], math.tau)
        rays = seen["rays"]
        costs = []  # far from the goal's direction is bad, and so is what stands near
        for k, one in enumerate(angles):
            near = min(rays[(k + j) % len(rays)] for j in range(-5, 6))
            costs.append(abs(math.remainder(one - bearing, math.tau)) + 4.0 * max(0.0, wide - near))
        angle = math.remainder(angles[costs.index(min(costs))], math.tau)
        if abs(angle - bearing) < math.tau / len(angles):
            angle = bearing
        ahead = min(rays[k] for k in range(-4, 5)) - robot["radius"]
        speed = robot["max_speed"] * max(0.0, math.cos(angle)) * min(1.0, ahead / ROOM)
        distance = math.hypot(gx - x, gy - y)
        answer = {"twist": [min(speed, max(0.1, distance)), 2.0 * angle]}
        print(json.dumps(answer), flush=True)


main()
