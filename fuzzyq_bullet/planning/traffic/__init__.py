"""What a planner does about moving obstacles: tracking, giving way, passive safety.

``lidar_scan`` and ``tracker`` find what moves, ``track`` and ``circle_fit`` describe it,
``give_way`` plans a detour, ``passive_safety`` limits the speed; ``avoidance`` joins them.
"""
