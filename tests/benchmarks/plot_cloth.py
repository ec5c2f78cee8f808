#!/usr/bin/env python3
"""Wet cloth, run time against error and by points: plot_cloth.py CONTEST.csv SPEED.csv OUT.png."""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STYLE = {
    "softpoint": ("#c1121f", "o", "-"),
    "softpoint, sweeps alone": ("#f28482", "o", "--"),
    "the thesis, scalar": ("#3a7d44", "^", "-"),
    "the thesis, SIMD double": ("#7fb069", "s", "-"),
    "the thesis, SIMD single": ("#1d5fa8", "D", "-"),
    "btSoftBody, dry": ("#7b2d8b", "v", "-"),
}
TITLE = {"lift_400cm3_centre": "400 cm³, lifted at the centre", "lift_400cm3_two_points": "400 cm³, lifted at two points",
         "vacuum_lift_2cm": "no air, lifted by 2 cm"}
MEASURES = (("force_error_N", "hand force, N (RMS of 0.1 s means)", 1), ("max_stretch", "largest stretch in the run, %", 100))


def points_of(rows, method, key, factor):
    points = []
    for row in rows:
        if row["method"] == method and row["ms_per_frame"] and row[key]:
            x, y = float(row["ms_per_frame"]), factor * float(row[key])
            if math.isfinite(x + y) and 0 < y < 1e5:
                points.append((x, y, row["setting"]))
    return sorted(points)


def main():
    contest, speed, target = sys.argv[1:4]
    with open(contest, newline="") as file:
        rows = list(csv.DictReader(file))
    with open(speed, newline="") as file:
        sizes = list(csv.DictReader(file))
    tasks = list(dict.fromkeys(row["task"] for row in rows))
    figure, axes = plt.subplots(2, len(tasks) + 1, figsize=(4.2 * (len(tasks) + 1), 7.6), squeeze=False)
    for column, task in enumerate(tasks):
        own = [row for row in rows if row["task"] == task]
        for line, (key, name, factor) in enumerate(MEASURES):
            axis = axes[line][column]
            for method, (colour, marker, _) in STYLE.items():
                points = points_of(own, method, key, factor)
                if not points:
                    continue
                axis.plot([p[0] for p in points], [p[1] for p in points], marker, color=colour, label=method, markersize=5)
                for x, y, setting in points:
                    if setting in ("default", "exact", "fast"):
                        axis.annotate(setting, (x, y), xytext=(4, 4), textcoords="offset points", fontsize=8)
            axis.axvline(1000 / 60, color="grey", linewidth=0.8, linestyle=":")
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.grid(True, alpha=0.3)
            axis.set_ylabel(name)
        axes[0][column].set_title(TITLE.get(task, task))
        axes[1][column].set_xlabel("ms a frame of 1/60 s, CPU time")
    axes[1][0].legend(fontsize=8)
    points = [int(row["points"]) for row in sizes]
    for line, (keys, name) in enumerate(((("solver_ms_per_frame",), "ms a frame of 1/60 s"),
                                         (("thesis_ms_per_step", "paper_scalar_ms_per_step", "paper_simd_ms_per_step"),
                                          "ms a step of 1/12000 s, with spheres"))):
        axis = axes[line][len(tasks)]
        for key in keys:
            drawn = [(p, float(row[key])) for p, row in zip(points, sizes) if row[key]]
            axis.plot([p[0] for p in drawn], [p[1] for p in drawn], "o-", markersize=4,
                      label=key.replace("_ms_per_step", "").replace("_ms_per_frame", "").replace("_", ", "))
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.grid(True, alpha=0.3)
        axis.set_ylabel(name)
        axis.legend(fontsize=8)
    axes[0][len(tasks)].set_title("cost by points")
    axes[1][len(tasks)].set_xlabel("points")
    figure.tight_layout()
    figure.savefig(target, dpi=80)


if __name__ == "__main__":
    main()
