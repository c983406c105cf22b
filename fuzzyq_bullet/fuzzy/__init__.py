"""Fuzzy inference, and the controller of the paper as data; it knows nothing of robots."""

from fuzzyq_bullet.fuzzy.inference import FuzzyController, Inference
from fuzzyq_bullet.fuzzy.paper import RuleTable, paper_controller

__all__ = ["FuzzyController", "Inference", "RuleTable", "paper_controller"]
