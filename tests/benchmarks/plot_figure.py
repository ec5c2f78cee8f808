#!/usr/bin/env python3
"""Integrators of figures, run time against error: plot_figure.py ACCURACY.csv OUT.svg. Needs nothing but Python."""
import csv
import math
import sys

COLORS = {"paper": "#3a7d44", "rk4": "#c1121f", "dopri5": "#1d5fa8", "variational": "#7b2d8b"}
WIDTH, HEIGHT, LEFT, TOP = 420, 330, 64, 36  # of a panel, and its margins


def power_of_ten(power):
    return f'10<tspan dy="-5" font-size="9">{power}</tspan>'.replace(">-", ">−")


def panel(rows, task, left):
    times = [float(r["us a simulated second"]) for r in rows if r["task"] == task]
    x_low, x_high = math.floor(math.log10(min(times))), math.ceil(math.log10(max(times)))
    y_low, y_high = -14, 0

    def x(value):
        return left + (math.log10(value) - x_low) / (x_high - x_low) * WIDTH

    def y(value):
        return TOP + (y_high - math.log10(value)) / (y_high - y_low) * HEIGHT

    out = [f'<rect x="{left}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="white" stroke="#888"/>',
           f'<text x="{left + WIDTH / 2}" y="{TOP - 12}" text-anchor="middle">{task.replace(";", ",")}</text>',
           f'<text x="{left + WIDTH / 2}" y="{TOP + HEIGHT + 38}" text-anchor="middle">µs a simulated second</text>']
    for power in range(x_low, x_high + 1):
        at = x(10.0**power)
        out.append(f'<path d="M{at:.1f} {TOP}v{HEIGHT}" stroke="#ddd"/>')
        out.append(f'<text x="{at:.1f}" y="{TOP + HEIGHT + 18}" text-anchor="middle">{power_of_ten(power)}</text>')
    for power in range(y_low, y_high + 1, 2):
        at = y(10.0**power)
        out.append(f'<path d="M{left} {at:.1f}h{WIDTH}" stroke="#ddd"/>')
        out.append(f'<text x="{left - 6}" y="{at + 4:.1f}" text-anchor="end">{power_of_ten(power)}</text>')
    out.append(f'<text transform="translate({left - 42} {TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">'
               'error at the end, m or rad</text>')
    for name, color in COLORS.items():
        points = [(float(r["us a simulated second"]), float(r["error"])) for r in rows
                  if r["task"] == task and r["integrator"] == name]
        points = sorted((x(t), y(e)) for t, e in points if math.isfinite(e) and 10.0**y_low <= e <= 10.0**y_high)
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"/>')
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{color}"/>' for a, b in points]
    return out


def main():
    with open(sys.argv[1], newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    tasks = list(dict.fromkeys(row["task"] for row in rows))
    out = []
    for k, task in enumerate(tasks):
        out += panel(rows, task, LEFT + k * (WIDTH + LEFT))
    for k, (name, color) in enumerate(COLORS.items()):
        at = TOP + HEIGHT - 70 + 18 * k
        out.append(f'<circle cx="{LEFT + 16}" cy="{at - 4}" r="4" fill="{color}"/>')
        out.append(f'<text x="{LEFT + 26}" y="{at}">{name}</text>')
    width, height = len(tasks) * (WIDTH + LEFT) + 20, TOP + HEIGHT + 50
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
                   f'font-family="sans-serif" font-size="13"><rect width="100%" height="100%" fill="#fafafa"/>\n')
        file.write("\n".join(out) + "\n</svg>\n")


main()
