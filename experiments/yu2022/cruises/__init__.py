"""Whole cruises: Tables 3, 4, 6 and 7 and Figs. 6 to 15 of Yu et al. 2022."""
