"""Ways round a formation: who comes from ahead of it passes it at a distance, and falls in behind.

A vessel that sailed straight for its guide segment would cross those of the others, and the slots
where some lie already.
"""

import numpy as np


def ways_round(
    start: np.ndarray,
    slots: np.ndarray,
    slot: np.ndarray,
    centre: np.ndarray,
    heading: np.ndarray,
    room: np.ndarray,
    guide_length: float,
) -> np.ndarray:
    """Points by way of which vessels come to their guide segments, on either side.

    Args:
        start: float64[B, n, 2] (m).
        slots: float64[B, S, 2], ahead of the formation's centre and to port (m).
        slot: int[B, n], which each vessel takes.
        centre: float64[B, 2] (m).
        heading: float64[B] (rad).
        room: float64[B], to keep from slots (m).
        guide_length: of the guide segments (m).

    Returns:
        float64[2, B, n, 3, 2] (m), of the nearer side first: abreast of the foremost slot, abreast
        of where the last vessel's guide segment begins, and there astern of its own slot; its start
        again instead of a point that it need not round.
    """
    bow = np.stack([np.cos(heading), np.sin(heading)], axis=-1)[:, None]
    port = np.stack([-bow[..., 1], bow[..., 0]], axis=-1)
    off = start - centre[:, None]
    ahead, abeam = np.sum(off * bow, axis=-1), np.sum(off * port, axis=-1)
    front = (slots[..., 0].max(axis=1) + room)[:, None]
    rear = (slots[..., 0].min(axis=1) - guide_length)[:, None]
    wide = (np.abs(slots[..., 1]).max(axis=1) + room)[:, None]
    rounds_front = (ahead > front) & (np.abs(abeam) < wide)
    rounds_rear = ahead > rear
    nearer = np.where(abeam < 0.0, -1.0, 1.0)
    lane = np.take_along_axis(slots[..., 1], slot.astype(np.int64), axis=1)
    front, rear = (np.broadcast_to(line, lane.shape) for line in (front, rear))
    astern = np.stack([rear, lane], axis=-1)
    ways = []
    for side in (nearer, -nearer):
        at_front = np.stack([front, side * wide], axis=-1)
        at_rear = np.stack([rear, side * wide], axis=-1)
        ways.append(np.stack([at_front, at_rear, astern], axis=2))
    local = np.stack(ways)
    bow, port = bow[:, :, None], port[:, :, None]
    there = centre[:, None, None] + local[..., :1] * bow + local[..., 1:] * port
    stays = np.stack([~rounds_front, ~rounds_rear, np.zeros_like(rounds_rear)], axis=-1)
    return np.where(stays[..., None], start[:, :, None], there)
