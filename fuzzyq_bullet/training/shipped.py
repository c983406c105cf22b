"""How each policy in ``assets/policies`` is made: the one place that says so.

As a program it prints the commands, one a line, for ``make policies``.
"""

from __future__ import annotations

from fuzzyq_bullet.training.order import Order

SHIPPED = {
    order.planner: order
    for order in (
        Order("q-learning", episodes=200, drive="kinematic", seed=0),
        Order("q-lambda", episodes=200, drive="kinematic", seed=0),
        Order("fuzzy-q-lambda", episodes=1500, drive="wheels", seed=1),
    )
}
"""By planner."""

if __name__ == "__main__":
    for order in SHIPPED.values():
        print(order.command)
