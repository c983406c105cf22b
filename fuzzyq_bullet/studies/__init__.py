"""Studies: questions to planners, put in many environments, whose answers are tables.

A study of one's own is a class with ``@register_study`` in a file that ``--plugin`` loads.
"""

from fuzzyq_bullet.studies.episodes import Environment, Row
from fuzzyq_bullet.studies.options import (
    PAPER,
    counts_of,
    described,
    drives_of,
    one_drive_of,
    planner_of,
    planners_of,
)
from fuzzyq_bullet.studies.plan import FieldsPlan, Plan
from fuzzyq_bullet.studies.registry import register_study, study_names, study_of
from fuzzyq_bullet.studies.study import Findings, Picture, Results, Stage, Study, Swept, Table

__all__ = [
    "PAPER",
    "Environment",
    "FieldsPlan",
    "Findings",
    "Picture",
    "Plan",
    "Results",
    "Row",
    "Stage",
    "Study",
    "Swept",
    "Table",
    "counts_of",
    "described",
    "drives_of",
    "one_drive_of",
    "planner_of",
    "planners_of",
    "register_study",
    "study_names",
    "study_of",
]
