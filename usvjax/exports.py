"""Where what `usvjax` exports stands; each module is imported on first use."""

HOME = {
    "usvjax.missions.cruise": ("CruiseParams", "CruiseResult", "CruiseStatic", "cruise"),
    "usvjax.planners": ("PlanResult", "plan_paths"),
    "usvjax.swarms": ("MinimiseResult", "minimise"),
    "usvjax.tours": ("TourResult", "optimal_tour", "solve_tour", "tour_length"),
    "usvjax.paths.metrics": (
        "PathMetrics",
        "path_metrics",
    ),
    "usvjax.paths.smoothing": (
        "DensePaths",
        "KeyPaths",
        "Splines",
        "bspline",
        "key_points",
        "redensify",
        "shorten",
    ),
    "usvjax.paths.tracking": (
        "Tracks",
        "track_paths",
    ),
    "usvjax.paths.turns": (
        "PathPieces",
        "SmoothTurns",
        "smooth_turns",
    ),
    "usvjax.presets": ("Preset", "preset", "preset_names"),
    "usvjax.search.astar": (
        "AstarResult",
        "astar",
    ),
    "usvjax.search.distance": ("distance_field",),
    "usvjax.search.replanning": (
        "DstarLiteResult",
        "dstar_lite",
    ),
    "usvkernels.paths.tracking": ("TrackParams",),
    "usvkernels.paths.turning": ("Turn",),
    "usvjax.errors": ("BadInputError", "BadTypeError"),
    "usvjax.maps": (
        "GridMap",
        "expand_obstacles",
        "hongze_lake",
        "load_map",
        "obstacle_table",
        "random_maps",
        "save_map",
    ),
    "usvjax.missions.dwa.candidates": ("DwaCandidates", "dwa_candidates"),
    "usvjax.missions.dwa.params": ("DwaParams", "DwaStatic", "fit_window"),
    "usvjax.missions.dwa.run": ("NavigateResult", "navigate_dwa"),
    "usvjax.missions.aggregate.run": ("AggregateResult", "aggregate"),
    "usvjax.missions.fleet.environment": (
        "Environment",
        "FieldCurrent",
        "ShearCurrent",
        "UniformCurrent",
        "VortexCurrent",
    ),
    "usvjax.missions.fleet.measures": ("MeetingKind", "Meetings", "meetings"),
    "usvjax.missions.fleet.params": ("FleetParams", "FleetStatic"),
    "usvjax.missions.fleet.run": ("FleetResult", "navigate"),
    "usvjax.study": ("load_run", "run_study"),
    "usvkernels.status": ("Status",),
}

EXPORTED = tuple(name for names in HOME.values() for name in names)


def home_of(name: str) -> str:
    """The module where what `usvjax` exports under a name stands; "" for no such name."""
    return next((module for module, names in HOME.items() if name in names), "")
