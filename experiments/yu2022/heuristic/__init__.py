"""The heuristic of D* Lite: Fig. 5 of Yu et al. 2022."""
