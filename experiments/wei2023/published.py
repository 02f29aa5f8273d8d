"""What Wei & Zhang 2023 print about their global path: Figs. 7 and 8, Table 2.

Source: G.-A. Wei, J.-Q. Zhang, "Research on Unmanned Surface Vessel Aggregation Formation Based on
Improved A* and Dynamic Window Approach Fusion Algorithm", Applied Sciences 13, 8625, 2023.
"""

UNIT = 0.05
"""Unit length of the global path, nm (Table 2)."""
COLLISION_RADIUS = 0.25
"""nm (Table 2)."""
OBSTACLES = 3
"""Of the environment of Figs. 7 and 8."""

BEFORE, AFTER = 41, 2
"""Steering points of the global path before and after smoothing (text on Figs. 7 and 8)."""
