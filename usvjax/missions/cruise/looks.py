"""How the methods of cruises look in figures; importing it fixes that."""

from usvjax.plots import style

LOOKS = {
    "astar": style.Look(style.BLACK, "-", "o"),
    "recommended": style.Look(style.BLUE, "-", "s"),
    "proposed": style.Look(style.VERMILLION, "--", "*"),
    "gwo": style.Look(style.ORANGE, "-.", "^"),
    "proposed_swap": style.Look(style.VERMILLION, ":", "X"),
    "gwo_swap": style.Look(style.ORANGE, ":", "<"),
    "aco": style.Look(style.GREEN, ":", "v"),
    "ga": style.Look(style.SKY, "--", "P"),
    "cmpso": style.Look(style.PURPLE, "-.", "D"),
}
style.register_looks(LOOKS)
