"""Whether a scenario is sound: what is seen can be touched, and what is asked can be done."""

from fuzzyq_bullet.doctor.examination import examine
from fuzzyq_bullet.doctor.finding import Finding

__all__ = ["Finding", "examine"]
