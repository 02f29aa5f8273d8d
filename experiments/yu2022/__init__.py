"""Yu et al. 2022: an improved D* Lite between the targets of a tour."""
