"""A planner that goes wrong as a scenario asks for: ``planner: {name: wrong, how: nan}``."""

import asyncio
import math
import os
import sys
import time
from typing import Literal

from fuzzyq_bullet import Decision, PlannerSettings, register_planner

DECISIONS = {
    "nan": Decision(heading=math.nan, step=0.2),
    "infinite": Decision(heading=math.inf, step=0.2),
    "huge": Decision(heading=1e300, step=0.2),
    "text": Decision(heading="left", step=0.2),
    "step-nan": Decision(heading=0.0, step=math.nan),
    "step-infinite": Decision(heading=0.0, step=math.inf),
    "backwards": Decision(heading=0.0, step=-0.2),
    "reach-nan": Decision(heading=0.0, step=0.2, reach=math.nan),
    "reach-negative": Decision(heading=0.0, step=0.2, reach=-1.0),
    "mode": Decision(heading=0.0, step=0.2, mode="flying"),
    "lines": Decision(heading=0.0, step=0.2, lines=(0.0, 1.0)),
    "rules": Decision(heading=0.0, step=0.2, rules=((1.0,) * 5,) * 4),
    "weights": Decision(heading=0.0, step=0.2, weights="ab"),
    "turn": Decision(heading=0.0, step=0.2, turn=1e300),
    "hopeless": Decision(heading=0.0, step=0.2, hopeless="perhaps"),
    "backward": Decision(heading=0.0, step=0.2, backward=1),
    "overflow": Decision(heading=0.0, step=10**400),
    "none": None,
    "tuple": (0.0, 0.2),
}


class Settings(PlannerSettings):
    name: Literal["wrong"] = "wrong"
    how: str = "nan"


class UnspeakableError(Exception):
    def __str__(self):
        raise ValueError("no words")


class Wrong:
    def __init__(self, how):
        self.how = how

    def decide(self, observation):
        if self.how in DECISIONS:
            return DECISIONS[self.how]
        return getattr(self, self.how.replace("-", "_"))(observation)

    def raises(self, observation):
        raise ValueError("no idea\n::error::where to go")

    def unspeakable(self, observation):
        raise UnspeakableError

    def exits(self, observation):
        sys.exit(0)

    def interrupts(self, observation):
        raise KeyboardInterrupt

    def recursion(self, observation):
        return self.recursion(observation)

    def cancels(self, observation):
        raise asyncio.CancelledError

    def forks(self, observation):
        os.fork()
        return DECISIONS["none"]

    def memory(self, observation):
        raise MemoryError

    def senses_nan(self, observation):
        observation.sense([0.0, math.nan])

    def senses_text(self, observation):
        observation.sense(["ahead"])

    def looks_nan(self, observation):
        observation.look([math.inf])

    def looks_too_far(self, observation):
        observation.look([0.0] * 20_000)

    def dies(self, observation):
        os._exit(0)

    def hangs(self, observation):
        time.sleep(600)


def build(settings, rng):
    if settings.how == "built-none":
        return None
    if settings.how == "built-exit":
        sys.exit(0)
    if settings.how == "built-raise":
        raise RuntimeError("out of order")
    return Wrong(settings.how)


register_planner("wrong", Settings, build)
