"""What a planner does about moving obstacles: tracking, giving way, passive safety.

``lidar_scan`` and ``tracker`` find what moves, ``track`` and ``circle_fit`` describe it,
``candidates`` are motions of the robot and what they come to, ``give_way`` chooses a detour,
``passive_safety`` limits the speed, ``going_on`` tells when it must not; ``avoidance`` joins them.
``guard`` does for other planners what ``passive_safety`` does, with ``twist_safety`` for twists.
"""
