"""Planners: an observation in, a decision out; they know nothing of PyBullet or files."""

from fuzzyq_bullet.planning.base import Motion, Observation, Planner, RangeSensor
from fuzzyq_bullet.planning.commands import Answer, CommandSettings, TwistCommand, WheelCommand
from fuzzyq_bullet.planning.decision import MODES, Decision, Mode
from fuzzyq_bullet.planning.fuzzy import FuzzyPlanner
from fuzzyq_bullet.planning.fuzzy_q_lambda import FuzzyQLambdaPlanner
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyPlanner
from fuzzyq_bullet.planning.peers.apf import ApfPlanner, ApfSettings
from fuzzyq_bullet.planning.peers.dwa import DwaPlanner, DwaSettings
from fuzzyq_bullet.planning.peers.navground import NavgroundPlanner, NavgroundSettings
from fuzzyq_bullet.planning.peers.tangent_bug import TangentBugPlanner, TangentBugSettings
from fuzzyq_bullet.planning.peers.vfh import VfhPlanner, VfhSettings
from fuzzyq_bullet.planning.policies import policy_of
from fuzzyq_bullet.planning.process.planner import ProcessPlanner, ProcessSettings
from fuzzyq_bullet.planning.q_learning import POLICY_SPECS, DirectPlanner
from fuzzyq_bullet.planning.registry import (
    DEFAULT_PLANNER,
    make_planner,
    planner_names,
    register_planner,
    settings_for,
)
from fuzzyq_bullet.planning.settings import (
    FuzzyQLambdaSettings,
    FuzzySettings,
    ImprovedFuzzySettings,
    PlannerSettings,
    QLambdaSettings,
    QLearningSettings,
    RoutineSettings,
)

__all__ = [
    "DEFAULT_PLANNER",
    "MODES",
    "Answer",
    "ApfPlanner",
    "ApfSettings",
    "CommandSettings",
    "Decision",
    "DirectPlanner",
    "DwaPlanner",
    "DwaSettings",
    "FuzzyPlanner",
    "FuzzyQLambdaPlanner",
    "FuzzyQLambdaSettings",
    "FuzzySettings",
    "ImprovedFuzzyPlanner",
    "ImprovedFuzzySettings",
    "Mode",
    "Motion",
    "NavgroundPlanner",
    "NavgroundSettings",
    "Observation",
    "Planner",
    "PlannerSettings",
    "ProcessPlanner",
    "ProcessSettings",
    "QLambdaSettings",
    "QLearningSettings",
    "RangeSensor",
    "RoutineSettings",
    "TangentBugPlanner",
    "TangentBugSettings",
    "TwistCommand",
    "VfhPlanner",
    "VfhSettings",
    "WheelCommand",
    "make_planner",
    "planner_names",
    "register_planner",
    "settings_for",
]

register_planner("fuzzy", FuzzySettings, lambda settings, rng: FuzzyPlanner(settings))
register_planner(
    "improved-fuzzy", ImprovedFuzzySettings, lambda settings, rng: ImprovedFuzzyPlanner(settings)
)
register_planner(
    "q-learning",
    QLearningSettings,
    lambda settings, rng: DirectPlanner(settings, policy_of(settings, POLICY_SPECS["q-learning"])),
)
register_planner(
    "q-lambda",
    QLambdaSettings,
    lambda settings, rng: DirectPlanner(settings, policy_of(settings, POLICY_SPECS["q-lambda"])),
)
register_planner(
    "fuzzy-q-lambda",
    FuzzyQLambdaSettings,
    lambda settings, rng: FuzzyQLambdaPlanner(settings),
)
register_planner("process", ProcessSettings, ProcessPlanner)
register_planner("dwa", DwaSettings, lambda settings, rng: DwaPlanner(settings))
register_planner("vfh", VfhSettings, lambda settings, rng: VfhPlanner(settings))
register_planner("apf", ApfSettings, lambda settings, rng: ApfPlanner(settings))
register_planner(
    "tangent-bug", TangentBugSettings, lambda settings, rng: TangentBugPlanner(settings)
)
register_planner("navground", NavgroundSettings, lambda settings, rng: NavgroundPlanner(settings))
