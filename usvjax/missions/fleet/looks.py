"""How the strategies of fleets look in figures; importing it fixes that."""

from usvjax.plots import style

LOOKS = {
    "none": style.Look(style.BLACK, ":", "X"),
    "rules": style.Look(style.BLUE, "-", "o"),
    "wei2023": style.Look(style.VERMILLION, "--", "*"),
    "orca": style.Look(style.GREEN, "-.", "^"),
}
style.register_looks(LOOKS)
