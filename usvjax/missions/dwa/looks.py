"""How the methods of DWA look in figures; importing it fixes that."""

from usvjax.plots import style

LOOKS = {
    "traditional": style.Look(style.ORANGE, "--", "s"),
    "improved": style.Look(style.BLUE, "-", "o"),
}
style.register_looks(LOOKS)
