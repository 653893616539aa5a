# SPDX-License-Identifier: MIT
"""Pictures for notebooks."""
import numpy as np


def triangulation(points, ring_ends, triangles, size):
    if len(points) == 0:
        return f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}" height="{size}"/>'
    low, high = points.min(axis=0), points.max(axis=0)
    extent = max(float((high - low).max()), 1e-300)
    margin = 0.02 * size
    scale = (size - 2 * margin) / extent
    placed = (points - low) * scale + margin
    width, height = (high - low) * scale + 2 * margin
    placed[:, 1] = height - placed[:, 1]  # y points up

    def ring(indices):
        return "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in placed[indices]) + "Z"

    inner = "".join(ring(t) for t in triangles)
    starts = np.concatenate([[0], ring_ends[:-1]]).astype(int)
    outline = "".join(ring(range(a, b)) for a, b in zip(starts, ring_ends) if b - a > 1)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.2f} {height:.2f}">'
        f'<path d="{inner}" fill="#dce6f2" stroke="#5b7fa6" stroke-width="0.8" stroke-linejoin="round"/>'
        f'<path d="{outline}" fill="none" stroke="#20405f" stroke-width="1.6" stroke-linejoin="round"/></svg>'
    )
