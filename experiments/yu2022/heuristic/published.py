"""What Yu et al. 2022 print about the heuristic of their D* Lite: Fig. 5 and its text.

Source: J. Yu et al., "A Hybrid Multi-Target Path Planning Algorithm for Unmanned Cruise Ship in
an Unknown Obstacle Environment", Sensors 22, 2429, 2022. Fig. 5 is a drawing without numbers.
"""

SAME_PATH = "the planning paths of the two methods were the same"
FEWER = "the number of expanded nodes ... were obviously less"

TRADITIONAL = "chebyshev"
"""Heuristic of the traditional D* Lite, the "chess-board distance"."""

HEURISTICS = {
    "chebyshev": "chess-board (traditional)",
    "octile": "octile",
    "weighted": "Eq. 17 as printed",
    "weighted_octile": "octile with the weight of Eq. 17",
}
"""What `dstar_lite` calls them to what the report does, the traditional one first."""

CHANGE = 0.03
"""Probability that a cell changes with a move."""
SENSING = (5, 5)
"""Rows and columns of the window that is seen."""
