# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles over deviation as an SVG, both axes logarithmic. Standard library alone."""
import math

COLORS = {"meshlode": "#1f5fbf", "openmesh": "#c0392b", "peer": "#7f8c8d"}
PANEL_W, PANEL_H, LEFT, TOP, BOTTOM = 360, 280, 62, 40, 46


def decade_ticks(low, high):
    return [10.0 ** k for k in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)]


def text(x, y, s, anchor="middle", size=11, extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}" {extra}>{s}</text>'


def panel(title, x_label, curves, x_offset):
    """curves: [(kind, label, [(deviation, triangles)], is_line)]"""
    points = [p for c in curves for p in c[2] if p[0] > 0 and p[1] > 0]
    if not points:
        return ""
    x_ticks = decade_ticks(min(p[0] for p in points), max(p[0] for p in points))
    y_ticks = decade_ticks(min(p[1] for p in points), max(p[1] for p in points))
    x0, x1, y0, y1 = map(math.log10, (x_ticks[0], x_ticks[-1], y_ticks[0], y_ticks[-1]))
    left, right = x_offset + LEFT, x_offset + PANEL_W - 14
    top, bottom = TOP, PANEL_H - BOTTOM

    def at(deviation, triangles):
        return (left + (math.log10(deviation) - x0) / max(x1 - x0, 1e-9) * (right - left),
                bottom - (math.log10(triangles) - y0) / max(y1 - y0, 1e-9) * (bottom - top))

    out = [text((left + right) / 2, TOP - 16, title, size=13, extra='font-weight="bold"'),
           text((left + right) / 2, PANEL_H - 10, x_label)]
    for t in x_ticks:
        x, _ = at(t, y_ticks[0])
        out.append(f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{bottom}" stroke="#ddd"/>')
        out.append(text(x, bottom + 15, f"1e{round(math.log10(t))}"))
    for t in y_ticks:
        _, y = at(x_ticks[0], t)
        out.append(f'<line x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}" stroke="#ddd"/>')
        out.append(text(left - 6, y + 4, f"{round(t):,}", anchor="end"))
    for kind, _, data, is_line in curves:
        color = COLORS[kind]
        data = sorted(p for p in data if p[0] > 0 and p[1] > 0)
        places = [at(*p) for p in data]
        if is_line and len(places) > 1:
            path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            out.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="1.6"/>')
        for x, y in places:
            if kind == "peer":
                out.append(f'<rect x="{x - 3.5:.1f}" y="{y - 3.5:.1f}" width="7" height="7" fill="{color}"/>')
            else:
                out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{color}"/>')
    return "\n".join(out)


def legend(curves, y):
    out, x = [], LEFT
    for kind, label, data, _ in curves:
        if not data:
            continue
        out.append(f'<rect x="{x}" y="{y - 9}" width="10" height="10" fill="{COLORS[kind]}"/>')
        out.append(text(x + 15, y, label, anchor="start"))
        x += 40 + 7 * len(label)
    return "\n".join(out)


def svg(name, max_curves, rms_curves):
    width, height = 2 * PANEL_W, PANEL_H + 24
    body = [panel(f"{name}: true maximum", "true maximum deviation, share of the diagonal", max_curves, 0),
            panel(f"{name}: true RMS", "true RMS deviation, share of the diagonal", rms_curves, PANEL_W),
            legend(max_curves if max_curves[-1][2] else rms_curves, PANEL_H + 14)]
    return ('<?xml version="1.0" encoding="UTF-8"?>\n<!-- SPDX-License-Identifier: GPL-3.0-or-later -->\n'
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            f'viewBox="0 0 {width} {height}" font-family="sans-serif" fill="#222">\n'
            f'<rect width="{width}" height="{height}" fill="#fff"/>\n' + "\n".join(body) + "\n</svg>\n")
