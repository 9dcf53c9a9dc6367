"""Plots as SVG: bars, and lines over linear or logarithmic axes. Text is the viewer's own."""
import math
from xml.sax.saxutils import escape

WIDTH, LINE_HEIGHT = 720, 360
LEFT, RIGHT, TOP, BOTTOM = 70, 130, 66, 50  # margins of a plot of lines
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d00", "#56b4e9")
OTHERS = "#9aa5b1"
STYLE = 'font-family="sans-serif" font-size="13" fill="#222"'


def text(x, y, words, anchor="start", more=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {more}>{escape(words)}</text>'


def svg(height, title, parts):
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
            f'width="{WIDTH}" height="{height}" {STYLE}>\n<rect width="100%" height="100%" '
            'fill="#fff"/>')
    return "\n".join([head, text(16, 24, title, more='font-weight="bold"'), *parts, "</svg>\n"])


def shown(number):
    """A number with three significant digits."""
    return f"{number:.3g}" if number < 1000 else f"{number:,.0f}"


def bars(title, groups, unit):
    """Horizontal bars. groups: [(heading, [(name, value, is ours)])]; each group has its own scale,
    because only its own bars compare."""
    parts, y, begin, room = [], 50, 250, 380
    for heading, rows in groups:
        parts.append(text(16, y, heading, more='fill="#555"'))
        y += 8
        longest = max(value for _, value, _ in rows)
        for name, value, is_ours in rows:
            length = max(1.5, room * value / longest)
            colour = COLOURS[0] if is_ours else OTHERS
            parts += [text(begin - 8, y + 13, name, "end"),
                      f'<rect x="{begin}" y="{y + 2}" width="{length:.1f}" height="14" '
                      f'fill="{colour}"/>',
                      text(begin + length + 6, y + 13, f"{shown(value)} {unit}")]
            y += 20
        y += 22
    return svg(y - 8, title, parts)


class Axis:
    """From values to pixels."""

    def __init__(self, values, first, last, logarithmic, from_zero=False):
        self._log = logarithmic
        low, high = min(values), max(values)
        if logarithmic:
            low, high = math.log10(low), math.log10(high)
            low, high = math.floor(low + 1e-9), math.ceil(high - 1e-9)
            high = max(high, low + 1)
            self.ticks = [10.0 ** power for power in range(low, high + 1)]
        else:
            low = 0 if from_zero else low
            step = nice_step((high - low) or 1)
            high = step * math.ceil(high / step)
            self.ticks = [low + step * i for i in range(round((high - low) / step) + 1)]
        self._low, self._high, self._first, self._last = low, high, first, last

    def __call__(self, value):
        value = math.log10(value) if self._log else value
        return self._first + (value - self._low) / (self._high - self._low) * (
            self._last - self._first)


def nice_step(span):
    power = 10 ** math.floor(math.log10(span / 4))
    return next(power * m for m in (1, 2, 5, 10) if span / (power * m) <= 5)


def lines(title, x_name, y_name, curves, logarithmic):
    """curves: [(name, [(x, y)])]"""
    x_axis = Axis([x for _, points in curves for x, _ in points], LEFT, WIDTH - RIGHT, logarithmic)
    y_axis = Axis([y for _, points in curves for _, y in points], LINE_HEIGHT - BOTTOM, TOP,
                  logarithmic, from_zero=True)
    parts = [text((LEFT + WIDTH - RIGHT) / 2, LINE_HEIGHT - 12, x_name, "middle"),
             text(16, TOP - 18, y_name)]
    for tick in x_axis.ticks:
        parts.append(text(x_axis(tick), LINE_HEIGHT - BOTTOM + 18, shown(tick), "middle"))
    for tick in y_axis.ticks:
        y = y_axis(tick)
        parts += [f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>',
                  text(LEFT - 8, y + 4, shown(tick), "end")]
    labels = spread([(y_axis(points[-1][1]), name, colour)
                     for (name, points), colour in zip(curves, COLOURS)])
    for (name, points), colour in zip(curves, COLOURS):
        path = " ".join(f"{x_axis(x):.1f},{y_axis(y):.1f}" for x, y in points)
        parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        if len(points) <= 12:
            parts += [f'<circle cx="{x_axis(x):.1f}" cy="{y_axis(y):.1f}" r="3" fill="{colour}"/>'
                      for x, y in points]
    parts += [text(WIDTH - RIGHT + 8, y + 4, name, more=f'style="fill:{colour}"')
              for y, name, colour in labels]
    return svg(LINE_HEIGHT, title, parts)


def spread(labels, least=16):
    """Move labels down until none covers another."""
    placed, below = [], -math.inf
    for y, name, colour in sorted(labels):
        below = max(y, below + least)
        placed.append((below, name, colour))
    return placed
