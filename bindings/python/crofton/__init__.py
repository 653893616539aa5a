# SPDX-License-Identifier: MIT
"""Exact culling and collision, and bounds and triangulations chosen by integral geometry."""
import numpy as _np

from . import _svg
from ._crofton import *  # noqa: F401,F403
from ._crofton import Mesh, Pvs, Triangulation, __version__, box_dtype, handle_dtype  # noqa: F401
from ._load import load, load_all, merge  # noqa: F401
from ._show import Picture


def boxes(center, half_extents, axes=None):
    """An array of box_dtype: centres (n, 3), half extents (n, 3) or (3,), axes (n, 3, 3) or (3, 3).

    axes[i, k] is the direction of axis k of box i; without axes they are x, y and z. Numbers are stored as floats, axes
    as the nearest, half extents as the next above: a box holds what it held.
    """
    center = _np.asarray(center, dtype="f8")
    if center.ndim != 2 or center.shape[1] != 3:
        raise TypeError("center: an array of shape (n, 3) is expected")
    result = _np.zeros(len(center), dtype=box_dtype)
    result["center"] = center
    half = _np.broadcast_to(_np.asarray(half_extents, dtype="f8"), center.shape)
    stored = half.astype("f4")
    result["half_extents"] = _np.where(stored < half, _np.nextafter(stored, _np.float32(_np.inf)), stored)
    result["axes"] = _np.eye(3) if axes is None else axes
    return result


def _triangulation_svg(self, size=400):
    """The triangulation as a picture: SVG, `size` pixels along the longer side."""
    return _svg.triangulation(self.points, self.ring_ends, self.triangles, size)


Triangulation.to_svg = _triangulation_svg
Triangulation._repr_svg_ = _triangulation_svg


class Chart:
    """Lines over one axis, as a picture: a notebook shows it. Numbers that are not finite leave gaps."""

    def __init__(self, x, series, x_label="", y_label=""):
        """`series`: a dict of names and values, as many as in `x`."""
        self.x = _np.array(x, dtype="f8")
        if self.x.ndim != 1:
            raise TypeError("x: an array of shape (n,) is expected")
        self.series = {str(name): _np.array(values, dtype="f8") for name, values in dict(series).items()}
        for name, values in self.series.items():
            if values.shape != self.x.shape:
                raise TypeError(f"series: {name!r} has shape {values.shape}, and x has {self.x.shape}")
        self.x_label, self.y_label = str(x_label), str(y_label)

    def to_svg(self, size=560):
        """SVG, `size` pixels wide."""
        return _svg.chart(self.x, self.series, self.x_label, self.y_label, size)

    def _repr_svg_(self):
        return self.to_svg()

    def __repr__(self):
        return f"Chart({', '.join(self.series)}; {len(self.x)} places)"


def _pvs_chart(self):
    """How many objects are seen from how many cells: a Chart of the share of all, cells in ascending order."""
    inner = [cell for cell, kind in enumerate(self.kinds) if kind > 1]
    share = _np.linspace(0, 100, max(len(inner), 1))
    series = {}
    for mode in ("conservative", "statistical"):
        seen = sorted(100.0 * self.visible(cell, mode).mean() for cell in inner)
        series[mode] = seen or [_np.nan]
    return Chart(share, series, "cells, %", "objects that may be seen, %")


def _mesh_show(self, *others):
    """A Picture of the mesh and other meshes or boxes, which a notebook shows."""
    return Picture([self, *others], title=self.name)


Mesh.show = _mesh_show
Pvs.chart = _pvs_chart
Pvs._repr_svg_ = lambda self: self.chart().to_svg()
