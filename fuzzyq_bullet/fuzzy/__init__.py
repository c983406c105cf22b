"""Fuzzy control: sets, rules, inference, and controllers as files; it knows nothing of robots."""

from fuzzyq_bullet.fuzzy.definition import ControllerDefinition, definition_of
from fuzzyq_bullet.fuzzy.formats import load_controller, save_controller
from fuzzyq_bullet.fuzzy.inference import FuzzyController, Inference, Method
from fuzzyq_bullet.fuzzy.paper import RuleTable, paper_controller, paper_definition

__all__ = [
    "ControllerDefinition",
    "FuzzyController",
    "Inference",
    "Method",
    "RuleTable",
    "definition_of",
    "load_controller",
    "paper_controller",
    "paper_definition",
    "save_controller",
]
