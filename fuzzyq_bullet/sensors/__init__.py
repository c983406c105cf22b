"""Range sensors: what the robot can learn of what stands around it, and how truly."""

from fuzzyq_bullet.sensors.base import (
    SENSORS,
    AnySensor,
    ExactSensor,
    SensorModel,
    register_sensor,
)
from fuzzyq_bullet.sensors.corridor import SENSOR_MARGIN, SPREAD, CorridorSensor

__all__ = [
    "SENSORS",
    "SENSOR_MARGIN",
    "SPREAD",
    "AnySensor",
    "CorridorSensor",
    "ExactSensor",
    "SensorModel",
    "register_sensor",
]
