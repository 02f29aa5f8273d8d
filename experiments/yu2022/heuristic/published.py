"""What Yu et al. 2022 print about the heuristic of their D* Lite: Figs. 3 to 5 and their text.

Source: J. Yu et al., "A Hybrid Multi-Target Path Planning Algorithm for Unmanned Cruise Ship in
an Unknown Obstacle Environment", Sensors 22, 2429, 2022. The figures are drawings without numbers.
"""

SAME_PATH = "the planning paths of the two methods were the same"
FEWER = "the number of expanded nodes ... were obviously less"

GOAL = "E3"
"""Of Figs. 3 and 4, whose rows are letters and whose columns are numbers."""
TIED = ("D2", "D3", "D4"), ("C1", "C2", "C3")
"""Nodes "with the same value" under the chess-board distance, row by row from the goal."""
EXPANDED = {"traditional": "four", "improved": "two"}
"""Nodes expanded when row D is done with."""

SENSING = (5, 5)
"""Rows and columns of the window that is seen."""
