# SPDX-License-Identifier: MIT
"""Exact culling and collision, and bounds and triangulations chosen by integral geometry."""
import numpy as _np

from . import _svg
from ._crofton import *  # noqa: F401,F403
from ._crofton import Triangulation, __version__, box_dtype, handle_dtype  # noqa: F401


def boxes(center, half_extents, axes=None):
    """An array of box_dtype: centres (n, 3), half extents (n, 3) or (3,), axes (n, 3, 3) or (3, 3).

    axes[i, k] is the direction of axis k of box i; without axes they are x, y and z.
    """
    center = _np.asarray(center, dtype="f8")
    if center.ndim != 2 or center.shape[1] != 3:
        raise TypeError("center: an array of shape (n, 3) is expected")
    result = _np.zeros(len(center), dtype=box_dtype)
    result["center"] = center
    result["half_extents"] = half_extents
    result["axes"] = _np.eye(3) if axes is None else axes
    return result


def _triangulation_svg(self, size=400):
    """The triangulation as a picture: SVG, `size` pixels along the longer side."""
    return _svg.triangulation(self.points, self.ring_ends, self.triangles, size)


Triangulation.to_svg = _triangulation_svg
Triangulation._repr_svg_ = _triangulation_svg
