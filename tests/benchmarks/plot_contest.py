#!/usr/bin/env python3
"""Run time against error: plot_contest.py IN.csv OUT.png [parts], with the CSV of bar_contest."""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STYLE = {
    "softpoint": ("#c1121f", "o", "-"),
    "softpoint, surfaces turned": ("#7a0010", "*", "--"),
    "softpoint, (4)": ("#e08a00", "s", ":"),
    "the paper": ("#3a7d44", "^", ""),
    "btSoftBody": ("#7b2d8b", "v", ""),
    "btDeformable": ("#1d5fa8", "D", ""),
}
TITLE = {"stretch": "stretched by 10 %", "bend": "bent by {angle:.0f}°", "twist": "twisted by {angle:.0f}°",
         "push": "pushed by half their length"}
# Which point bears the name (from the fastest), how far from it in points.
LABEL = {"softpoint": (-1, (6, 6), "left"), "softpoint, surfaces turned": (0, (0, -14), "left"),
         "softpoint, (4)": (-1, (4, -16), "right"),
         "the paper": (0, (-4, 7), "left"), "btSoftBody": (-1, (6, 8), "right"),
         "btDeformable": (-1, (6, 7), "right")}
MEASURES = (("end_error", "error of the end's force or moment\n(push: of the tip, in parts of the length), %"),
            ("position_error", "error of positions\n(in parts of how far they moved), %"))


def value(row, key):
    return float(row[key]) if row[key] else math.nan


def points_of(rows, method, key):
    points = [(1e3 * value(row, "seconds_per_frame"), 100.0 * value(row, key), row["setting"])
              for row in rows if row["method"] == method]
    return sorted(p for p in points if math.isfinite(p[0] + p[1]) and 0 < p[1] < 1e4)


def mark_default(axis, points):
    for x, y, setting in points:
        if setting == "tolerance 1e-4":
            axis.plot(x, y, "o", color="none", markeredgecolor="black", markersize=12, zorder=5)
            axis.annotate("default", (x, y), xytext=(0, 9), textcoords="offset points", ha="center")


def draw(axis, rows, key):
    for method, (colour, marker, line) in STYLE.items():
        points = points_of(rows, method, key)
        if not points:
            continue
        drawn = [p for p in points if p[2].find("double") < 0]
        axis.plot([p[0] for p in drawn], [p[1] for p in drawn], marker=marker, linestyle="", color=colour,
                  markersize=5)
        if line:
            axis.plot([p[0] for p in drawn], [p[1] for p in drawn], line, color=colour, linewidth=1, alpha=0.6)
        if method == "softpoint":
            mark_default(axis, points)
        index, offset, side = LABEL[method]
        axis.annotate(method.removeprefix("softpoint, "), drawn[index][:2], xytext=offset, textcoords="offset points", ha=side, color=colour)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.grid(True, alpha=0.3)


def main():
    source, target = sys.argv[1], sys.argv[2]
    parts = sys.argv[3] if len(sys.argv) > 3 else "13"
    with open(source, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["parts"] == parts]
    tasks = list(dict.fromkeys(row["task"] for row in rows))
    plt.rcParams.update({"font.size": 10})
    figure, axes = plt.subplots(2, len(tasks), figsize=(3.9 * len(tasks), 7.4), sharex=True, sharey="row",
                                squeeze=False)
    for column, task in enumerate(tasks):
        for line, (key, name) in enumerate(MEASURES):
            axis = axes[line][column]
            draw(axis, [row for row in rows if row["task"] == task], key)
            if column == 0:
                axis.set_ylabel(name)
            axis.set_ylim((2e-2, 1e4) if line == 0 else (2e-2, 3e2))
        axes[0][column].set_title(f"{parts} cylinders " + TITLE[task].format(angle=90 * int(parts) / 13))
        axes[1][column].set_xlabel("ms a frame, CPU time")
    figure.tight_layout()
    figure.savefig(target, dpi=80)


if __name__ == "__main__":
    main()
