"""Small pictures of curves over time as SVG text, for pages that need no plotting library."""
import html
import math

COLOURS = ("#1f5fa8", "#c2571a", "#2c8a4b", "#8b3fa0", "#555555")


def steps(low, high, wanted=5):
    """Round numbers between low and high, about `wanted` of them."""
    raw = max(high - low, 1e-12) / wanted
    unit = 10.0 ** math.floor(math.log10(raw))
    step = next(unit * factor for factor in (1, 2, 5, 10) if raw <= unit * factor)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


def thinned(time_s, curve, most):
    """At most `most` points, the extremes of each stretch among them: no peak is lost."""
    every = max(1, 2 * len(time_s) // most)
    for begin in range(0, len(time_s), every):
        places = range(begin, min(begin + every, len(time_s)))
        for k in sorted({min(places, key=curve.__getitem__), max(places, key=curve.__getitem__)}):
            yield time_s[k], curve[k]


def panel(title, unit, time_s, curves, width=620, height=250, most=1000):
    """One picture: `curves` maps a name to its values at `time_s`."""
    left, right, top, bottom = 62, 12, 30, 46
    values = [v for curve in curves.values() for v in curve]
    low, high = min(values), max(values)
    margin = 0.06 * (high - low) or 1.0
    low, high = low - margin, high + margin
    begin, end = time_s[0], time_s[-1]

    def x(t):
        return left + (t - begin) / (end - begin) * (width - left - right)

    def y(v):
        return height - bottom - (v - low) / (high - low) * (height - top - bottom)

    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="{html.escape(title)}" '
             'style="font:12px sans-serif;fill:#333">', f'<text x="{left}" y="18" style="font-weight:600">{html.escape(title)}</text>']
    for v in steps(low, high):
        parts.append(f'<path d="M{left} {y(v):.1f}H{width - right}" stroke="#e4e4e4"/><text x="{left - 6}" y="{y(v) + 4:.1f}" text-anchor="end">{v:g}</text>')
    for t in steps(begin, end, 8):
        parts.append(f'<text x="{x(t):.1f}" y="{height - bottom + 16}" text-anchor="middle">{t:g}</text>')
    parts.append(f'<rect x="{left}" y="{top}" width="{width - left - right}" height="{height - top - bottom}" fill="none" stroke="#888"/>')
    for (name, curve), colour, place in zip(curves.items(), COLOURS, range(len(curves))):
        points = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in thinned(time_s, curve, most))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.4"/>')
        at = left + place * (width - left - right) / max(len(curves), 4)
        parts.append(f'<path d="M{at:.0f} {height - 10}h18" stroke="{colour}" stroke-width="2"/><text x="{at + 23:.0f}" y="{height - 6}">{html.escape(name)}</text>')
    parts.append(f'<text x="{width - right}" y="{height - 6}" text-anchor="end">{html.escape(unit)} over s</text></svg>')
    return "\n".join(parts)
