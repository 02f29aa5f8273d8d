"""The swarms on test functions: Tables 8 and 9, Figs. 2 and 16 of Yu et al. 2022."""
