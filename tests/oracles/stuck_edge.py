"""Whether a rule of being stuck sits where rounding decides who is."""

from usvjax import DwaParams


def sits_on_an_edge(p: DwaParams) -> bool:
    """Whether vessels that hold a speed, or the slowest that hold a course, end just there."""
    speed_steps = p.stuck_distance / (p.v_step * p.stuck_time)
    if abs(speed_steps - round(speed_steps)) <= 0.02:
        return True
    steps = p.stuck_distance / (p.v_step * p.dt)
    # Farther, courses that are straight for so long are rare.
    return steps < 150 and abs(steps - round(steps)) <= 0.1
