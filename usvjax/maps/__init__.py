"""Maps: the grid in the world, map files, the packaged lake, obstacles, where scenes come from."""

from usvjax.maps.cells import random_maps
from usvjax.maps.files import load_map, save_map
from usvjax.maps.grid_map import GridMap
from usvjax.maps.hongze import find_map, hongze_lake, packaged_names
from usvjax.maps.obstacles import expand_obstacles, obstacle_table

__all__ = [
    "GridMap",
    "expand_obstacles",
    "find_map",
    "hongze_lake",
    "load_map",
    "obstacle_table",
    "packaged_names",
    "random_maps",
    "save_map",
]
