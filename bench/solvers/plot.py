#!/usr/bin/env python3
"""Draws error against cost from the CSV files of fascia_bench_solvers.

    plot.py OUT.svg TITLE=FILE.csv [TITLE=FILE.csv ...]

The schemes under comparison are scalar code, the product's leapfrog is not. Their stepping time is
divided by what SIMD gains for the leapfrog (its scalar twin over itself, at the same steps), as if
they could be vectorised as well.
"""

import csv
import math
import sys

WIDTH, HEIGHT, LEFT, TOP, BOTTOM, GAP = 470, 420, 70, 48, 56, 40
CURVES = [  # scheme, passes, name, colour
    ("leapfrog", "0", "stabilised leapfrog (default)", "#c0392b"),
    ("xpbd-small-steps", "1", "XPBD, small steps", "#2471a3"),
    ("block-descent", "2", "vertex block descent, 2 passes", "#7fb77e"),
    ("block-descent", "8", "vertex block descent, 8 passes", "#1e8449"),
    ("implicit-euler", "0", "implicit Euler, sparse factorisation", "#7d3c98"),
    ("auto", "0", "as the library chooses", "#c0392b"),
]


def number(row, key):
    return float(row[key])


def rest_us(rows):
    """Posing and contact per frame: the same for all schemes of a file."""
    spans = [number(r, "cpu_us_per_frame") - number(r, "stepping_us_per_frame")
             for r in rows if r["scheme"] == "leapfrog-scalar"]
    return sorted(spans)[len(spans) // 2]


def simd_gain(rows):
    def stepping(scheme):
        of = [r for r in rows if r["scheme"] == scheme]
        longest = max(of, key=lambda r: number(r, "steps_per_frame"))
        return longest

    twin, product = stepping("leapfrog-scalar"), stepping("leapfrog")
    return number(twin, "stepping_us_per_frame") / (
        number(product, "cpu_us_per_frame") - rest_us(rows))


def points_of(rows, scheme, passes):
    gain = simd_gain(rows)
    out = []
    for row in rows:
        if (row["scheme"], row["passes"]) != (scheme, passes):
            continue
        cost, stepping = number(row, "cpu_us_per_frame"), number(row, "stepping_us_per_frame")
        out.append((cost - stepping + stepping / gain, number(row, "rms_mm")))
    return sorted(out)


def log_ticks(low, high):
    return [10.0 ** e for e in range(math.ceil(math.log10(low)), math.floor(math.log10(high)) + 1)]


def panel(title, rows, left, ranges):
    (x0, x1), (y0, y1) = ranges
    plot_w, plot_h = WIDTH - LEFT, HEIGHT - TOP - BOTTOM

    def x(cost):
        return left + LEFT + plot_w * math.log(cost / x0) / math.log(x1 / x0)

    def y(error):
        return TOP + plot_h * (1 - math.log(error / y0) / math.log(y1 / y0))

    svg = [f'<text x="{left + LEFT}" y="{TOP - 16}" class="title">{title}</text>']
    for tick in log_ticks(x0, x1):
        svg.append(f'<path d="M{x(tick):.1f} {TOP}V{TOP + plot_h}" class="grid"/>'
                   f'<text x="{x(tick):.1f}" y="{TOP + plot_h + 18}" class="x">{tick:g}</text>')
    for tick in log_ticks(y0, y1):
        svg.append(f'<path d="M{left + LEFT} {y(tick):.1f}H{left + WIDTH}" class="grid"/>'
                   f'<text x="{left + LEFT - 8}" y="{y(tick) + 4:.1f}" class="y">{tick:g}</text>')
    svg.append(f'<text x="{left + LEFT + plot_w / 2}" y="{HEIGHT - 14}" class="x">'
               "processor time per frame, µs, at equal SIMD</text>")
    svg.append(f'<text transform="translate({left + 22} {TOP + plot_h / 2}) rotate(-90)" '
               'class="x">RMS distance to the reference, mm</text>')
    for scheme, passes, _, colour in CURVES:
        dots = [(x(c), y(e)) for c, e in points_of(rows, scheme, passes)
                if x0 <= c <= x1 and y0 <= e <= y1]
        if len(dots) > 1:
            path = "L".join(f"{a:.1f} {b:.1f}" for a, b in dots)
            svg.append(f'<path d="M{path}" stroke="{colour}" class="curve"/>')
        radius = 7 if scheme == "auto" else 3.5
        fill = "none" if scheme == "auto" else colour
        svg += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{radius}" fill="{fill}" '
                f'stroke="{colour}" stroke-width="2"/>' for a, b in dots]
    return svg


def legend(top):
    svg = []
    for n, (scheme, _, name, colour) in enumerate(CURVES):
        a, b = LEFT + (n % 3) * 300, top + 22 * (n // 3)
        fill = "none" if scheme == "auto" else colour
        svg.append(f'<circle cx="{a}" cy="{b - 4}" r="5" fill="{fill}" stroke="{colour}" '
                   f'stroke-width="2"/><text x="{a + 12}" y="{b}">{name}</text>')
    return svg


def main(out, *named_files):
    panels = []
    for named in named_files:
        title, path = named.rsplit("=", 1)
        with open(path, newline="") as file:
            panels.append((title, list(csv.DictReader(file))))
    every = [p for _, rows in panels for s, n, _, _ in CURVES for p in points_of(rows, s, n)]
    costs, errors = [c for c, _ in every], [e for _, e in every]
    ranges = ((min(costs) / 1.3, max(costs) * 1.3), (min(errors) / 1.3, max(errors) * 1.3))
    width = len(panels) * (WIDTH + GAP) + GAP // 2
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT + 60}" '
           'font-family="sans-serif" font-size="13"><style>.grid{stroke:#ddd}'
           ".curve{fill:none;stroke-width:2}.x{text-anchor:middle}.y{text-anchor:end}"
           ".title{font-weight:bold;font-size:15px}</style>"
           '<rect width="100%" height="100%" fill="white"/>']
    for n, (title, rows) in enumerate(panels):
        svg += panel(title, rows, n * (WIDTH + GAP), ranges)
        print(f"{title}: SIMD gains the leapfrog a factor of {simd_gain(rows):.1f}")
    svg += legend(HEIGHT + 22) + ["</svg>"]
    with open(out, "w") as file:
        file.write("\n".join(svg) + "\n")


if __name__ == "__main__":
    if len(sys.argv) < 3 or not all("=" in a for a in sys.argv[2:]):
        sys.exit(__doc__)
    main(*sys.argv[1:])
