"""A differential-drive robot that finds its way among obstacles it has never seen.

    from fuzzyq_bullet import load_scenario, result_of, run

    trajectory = run(load_scenario("mixed"))
    print(result_of(trajectory).outcome)

Each public name is imported when it is first asked for, so that importing the package costs
nothing and loads no PyBullet. The environments are known to Gymnasium from then on.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fuzzyq_bullet.gym_ids import register_when_imported
from fuzzyq_bullet.version import __version__

if TYPE_CHECKING:
    from fuzzyq_bullet.episode import run
    from fuzzyq_bullet.errors import UserError
    from fuzzyq_bullet.planning import (
        CommandSettings,
        Decision,
        Observation,
        Planner,
        PlannerSettings,
        TwistCommand,
        WheelCommand,
        register_planner,
    )
    from fuzzyq_bullet.recording.metrics import Result, result_of
    from fuzzyq_bullet.recording.trajectory import Trajectory
    from fuzzyq_bullet.scenario import Scenario, load_scenario, with_options
    from fuzzyq_bullet.video.record import frame, record

__all__ = [
    "CommandSettings",
    "Decision",
    "Observation",
    "Planner",
    "PlannerSettings",
    "Result",
    "Scenario",
    "Trajectory",
    "TwistCommand",
    "UserError",
    "WheelCommand",
    "__version__",
    "frame",
    "load_scenario",
    "record",
    "register_planner",
    "result_of",
    "run",
    "with_options",
]

_HOMES = {
    "Decision": "planning",
    "Observation": "planning",
    "Planner": "planning",
    "CommandSettings": "planning",
    "PlannerSettings": "planning",
    "TwistCommand": "planning",
    "WheelCommand": "planning",
    "Result": "recording.metrics",
    "Scenario": "scenario",
    "Trajectory": "recording.trajectory",
    "UserError": "errors",
    "frame": "video",
    "load_scenario": "scenario",
    "record": "video",
    "register_planner": "planning",
    "result_of": "recording.metrics",
    "run": "episode",
    "with_options": "scenario",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value  # from now on it is found without coming here
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


register_when_imported()
