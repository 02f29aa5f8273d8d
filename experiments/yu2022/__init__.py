"""Yu et al. 2022: a tour of targets, and an improved D* Lite between them."""
