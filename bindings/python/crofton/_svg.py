# SPDX-License-Identifier: MIT
"""Pictures for notebooks."""
from xml.sax.saxutils import escape

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


COLORS = ("#2f6db3", "#d1761c", "#3a8f5c", "#9a4fa8", "#8a6d3b", "#c0392b")


def _ticks(low, high, count=5):
    """Round numbers from low to high."""
    step = (high - low) / count
    size = 10.0 ** np.floor(np.log10(step))
    step = next(k * size for k in (1, 2, 5, 10) if k * size >= step * 0.999)
    return np.arange(np.ceil(low / step), np.floor(high / step + 1e-9) + 1) * step


def _range(values):
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def chart(x, series, x_label, y_label, size):
    """Lines over one axis. `series`: names and values; gaps where a value is not finite."""
    width, height = size, 0.6 * size
    left, right, top, bottom = 64, 12, 12 + 18 * len(series), 44
    (x0, x1), (y0, y1) = _range(x), _range(np.concatenate([np.ravel(y) for y in series.values()] or [np.zeros(0)]))

    def place(px, py):
        return (left + (px - x0) / (x1 - x0) * (width - left - right),
                height - bottom - (py - y0) / (y1 - y0) * (height - top - bottom))

    def text(px, py, words, anchor="middle", turn=""):
        return f'<text x="{px:.1f}" y="{py:.1f}" text-anchor="{anchor}"{turn}>{escape(words)}</text>'

    parts = []
    for t in _ticks(x0, x1):
        px, _ = place(t, y0)
        parts.append(f'<path d="M{px:.1f} {top}V{height - bottom:.1f}" stroke="#e3e3e3"/>' + text(px, height - bottom + 16, f"{t:g}"))
    for t in _ticks(y0, y1):
        _, py = place(x0, t)
        parts.append(f'<path d="M{left} {py:.1f}H{width - right:.1f}" stroke="#e3e3e3"/>' + text(left - 6, py + 4, f"{t:g}", "end"))
    for i, (name, values) in enumerate(series.items()):
        color, line, pen = COLORS[i % len(COLORS)], "", "M"
        for px, py in zip(x, values):
            finite = np.isfinite(px) and np.isfinite(py)
            line += "{}{:.2f} {:.2f}".format(pen, *place(px, py)) if finite else ""
            pen = "L" if finite else "M"
        parts.append(f'<path class="line" d="{line}" fill="none" stroke="{color}" stroke-width="1.8"/>')
        parts.append(f'<path d="M{left} {14 + 18 * i}h18" stroke="{color}" stroke-width="3"/>' + text(left + 24, 18 + 18 * i, name, "start"))
    parts.append(text((left + width - right) / 2, height - 8, x_label))
    middle = (top + height - bottom) / 2
    parts.append(text(14, middle, y_label, turn=f' transform="rotate(-90 14 {middle:.1f})"'))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>{"".join(parts)}</svg>'
    )
