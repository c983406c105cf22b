"""Range sensors: what the robot can learn of what stands around it, and how truly."""

from fuzzyq_bullet.sensors.base import (
    SENSORS,
    AnySensor,
    ExactSensor,
    SensorModel,
    register_sensor,
)
from fuzzyq_bullet.sensors.corridor import SENSOR_MARGIN, SPREAD, WIDEST, CorridorSensor, offsets

__all__ = [
    "SENSORS",
    "SENSOR_MARGIN",
    "SPREAD",
    "WIDEST",
    "AnySensor",
    "CorridorSensor",
    "ExactSensor",
    "SensorModel",
    "offsets",
    "register_sensor",
]
