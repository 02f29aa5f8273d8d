"""How the methods of path planning look in figures; importing it fixes that."""

from usvjax.plots import style

LOOKS = {
    "astar": style.Look(style.BLACK, "-", "o"),
    "manhattan": style.Look(style.ORANGE, "--", "s"),
    "weighted": style.Look(style.PURPLE, ":", "d"),
    "turning": style.Look(style.GREEN, "-.", "h"),
    "turning_parent": style.Look(style.SKY, "--", "<"),
    "shortened": style.Look(style.BLUE, "-", "v"),
    "key_points": style.Look(style.BLUE, ":", "p"),
    "smoothed": style.Look(style.VERMILLION, "-", "*"),
    "bspline": style.Look(style.PURPLE, "--", "X"),
}
style.register_looks(LOOKS)
