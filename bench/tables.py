"""The tables of docs/, made of the results in bench/results. Used by script/measure.

A table stands between `<!-- NAME -->` and `<!-- end -->` on its page; TABLES says which page.
"""

import csv
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench" / "results"
sys.path.insert(0, str(ROOT / "bench" / "solvers"))
import plot  # noqa: E402


def table(head, rows):
    lines = [head, ["---"] * len(head)] + rows
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def code(lines):
    return "\n".join("    " + line for line in lines)


def percent(share):
    return f"{100 * share:.0f}"


def brief(value):
    """Three digits, or all before the point."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def paper(result):
    head = ["character", "solver", "paper, × real time", "ours", "ratio", "step, ms", "forces %",
            "constraints %", "longest edge, ×", "deepest, mm", "put back"]

    def row(r):
        if "refused" in r:
            return [r["character"], r["integrator"], "", "refused: " + r["refused"]] + 7 * [""]
        return [r["character"], r["integrator"], f"{r['paper_realtime_ratio']:.3f}",
                f"{r['realtime_ratio']:.1f}", f"{r['speedup']:.0f}",
                f"{1e3 * r['step_min_s']:.2f}–{1e3 * r['step_max_s']:.2f}",
                percent(r["share_forces"]), percent(r["share_constraints"]),
                f"{r['max_edge_stretch']:.2f}", f"{1e3 * r['max_penetration_m']:.4f}",
                f"{r['repaired_points']:.0f}"]

    return table(head, [row(r) for r in result["results"]])


def scaling(result):
    head = ["points", "threads", "× real time", "ms per frame", "steps per frame",
            "ns per point and step", "forces %", "constraints %", "other %", "bytes per point",
            "deepest, mm", "largest stretch"]
    return table(head, [[
        r["points"], r["threads"], f"{r['realtime_ratio']:.1f}", f"{1e3 * r['frame_s']:.3f}",
        f"{r['steps_per_frame']:.0f}", f"{r['ns_per_point_and_step']:.1f}",
        percent(r["share_forces"]), percent(r["share_constraints"]), percent(r["share_other"]),
        f"{r['bytes_per_point']:.0f}", f"{1e3 * r['max_penetration_m']:.4f}",
        f"{r['max_edge_stretch']:.2f}"] for r in result["results"]])


def sheet(result):
    head = ["points", "engine", "setting", "threads", "× real time", "median",
            "stretch, largest / 99th percentile", "deepest, mm", "lost points"]
    return table(head, [[
        r["points"], r["engine"], r["setting"], r["threads"], f"{r['realtime_ratio']:.2f}",
        f"{r['realtime_ratio_median']:.2f}",
        f"{100 * r['stretch_max']:.1f} / {100 * r['stretch_p99']:.1f} %",
        f"{1e3 * r['penetration_m']:.2f}", f"{r['lost_points']:.0f}"] for r in result["results"]])


def editing(result):
    head = ["character", "points", "edit", "edited, ms", "carryOver, ms", "next frame, ms",
            "a usual frame, ms"]
    return table(head, [[
        r["character"], r["points"], e["edit"], brief(e["edit_ms"]), brief(e["carry_over_ms"]),
        brief(e["first_frame_ms"]), brief(e["frame_ms"])]
        for r in result["results"] for e in r["edits"]])


def rigs(result):
    head = ["rig", "points", "motion", "threads", "× real time", "largest stretch"]
    return table(head, [[
        r["rig"], r["vertices"], r["motion"], r["threads"], brief(r["realtime_ratio"]),
        f"{r['max_edge_stretch']:.2f}"] for r in result["results"]])


def drawing(result):
    head = ["drawn", "look", "frame, ms on the clock / of processor time", "first picture, ms",
            "frames/s"]
    return table(head, [[
        r["file"].split(".")[0], r["look"],
        f"{r['frame']['wall_ms']:.0f} / {r['frame']['processor_ms']:.0f}",
        f"{r['first']['wall_ms']:.0f}", f"{1e3 / r['frame']['wall_ms']:.0f}"]
        for r in result["results"]])


def helpers(result):
    head = ["clip", "helpers", "RMS / largest, % of the height", "processor time, s"]
    return table(head, [[
        r["clip"], r["helpers"], f"{r['rms_percent']:.2g} / {r['max_percent']:.2g}",
        f"{r['processor_s']:.2f}"] for r in result["results"]])


def kernels(result):
    return table(["kernel / columns / rows", "ns per point"], [[
        b["run_name"], f"{1e9 * b['s_per_point']:.1f}"]
        for b in result["benchmarks"]
        if b.get("aggregate_name") == "median" and "s_per_point" in b])


SCHEMES = {"auto": "as the library chooses", "leapfrog": "leapfrog",
           "xpbd-small-steps": "XPBD", "block-descent": "block descent",
           "implicit-euler": "implicit Euler"}


def scheme(row):
    name = SCHEMES[row["scheme"]]
    if row["scheme"] in ("auto", "implicit-euler"):
        return name
    passes = f" × {row['passes']} passes" if row["passes"] not in ("0", "1") else ""
    return f"{name}, {float(row['steps_per_frame']):.0f} steps{passes}"


def solvers(result):
    """Both skins side by side; whatever was not finished in time is missing."""
    sides = []
    for name in ("soft", "stiff"):
        rows = list(csv.DictReader(result[name].splitlines()))
        gain = plot.simd_gain(rows)
        side = {}
        for row in rows:
            if row["scheme"] not in SCHEMES:
                continue
            measured, stepping = float(row["cpu_us_per_frame"]), float(row["stepping_us_per_frame"])
            cost = f"{measured - stepping + stepping / gain:.0f}"
            if stepping:
                cost += f" ({measured:.0f})"
            side[scheme(row)] = [cost, f"{float(row['rms_mm']):.2f} / {float(row['max_mm']):.1f}"]
        sides.append(side)
    names = list(dict.fromkeys(name for side in sides for name in side))
    nothing = ["not finished", "–"]
    head = ["scheme, steps per frame", "soft: µs", "soft: mm", "stiff: µs", "stiff: mm"]
    return table(head, [[n] + sides[0].get(n, nothing) + sides[1].get(n, nothing) for n in names])


def large_solvers(result):
    rows = csv.DictReader(result["large"].splitlines())
    head = ["scheme", "steps per frame", "µs per frame", "RMS / largest error, mm"]
    return table(head, [[
        SCHEMES[r["scheme"]], f"{float(r['steps_per_frame']):.0f}",
        f"{float(r['cpu_us_per_frame']):.0f}",
        f"{float(r['rms_mm']):.2f} / {float(r['max_mm']):.1f}"]
        for r in rows if r["scheme"] in SCHEMES])


def teleport(result):
    head = ["frame, ms", "deepest point, µm", "largest stretch", "with steps as long as intervals"]
    return table(head, [[
        f"{float(r['frame_ms']):.3g}", f"{r['deepest_um']:.2f}", f"{r['stretch']:.2f}",
        f"{r['long_step_stretch']:.2f}"] for r in result["results"]])


def fox_info(result):
    return code(result["info"])


def fox_bones(result):
    return code(result["bones"])


def fox_morphs(result):
    return code(result["morphs"])


# name of a table: its page, what makes it of a result, and the result's name
TABLES = {
    "paper": ("performance", paper, "paper"),
    "scaling": ("performance", scaling, "scaling"),
    "editing": ("performance", editing, "editing"),
    "rigs": ("performance", rigs, "rigs"),
    "drawing": ("performance", drawing, "drawing"),
    "helpers": ("performance", helpers, "helpers"),
    "sheet": ("performance", sheet, "sheet"),
    "kernels": ("performance", kernels, "kernels"),
    "solvers": ("solvers", solvers, "solvers"),
    "large-solvers": ("solvers", large_solvers, "solvers"),
    "teleport": ("never-explodes", teleport, "teleport"),
    "fox-info": ("first-character", fox_info, "fox"),
    "fox-bones": ("first-character", fox_bones, "fox"),
    "fox-morphs": ("first-character", fox_morphs, "fox"),
}


def where(result):
    taken = result["taken"]
    return (f"*Taken {taken['date']} of {taken['commit']}: {taken['processor']}, "
            f"{taken['threads']} threads.*")


def write():
    for name, (page, render, result) in TABLES.items():
        file = RESULTS / f"{result}.json"
        if not file.exists():
            continue
        found = json.loads(file.read_text())
        path = ROOT / "docs" / f"{page}.md"
        text = path.read_text()
        pattern = rf"(<!-- {name} -->\n).*?(<!-- end -->)"
        body = f"{render(found)}\n\n{where(found)}"
        text, count = re.subn(pattern, lambda m: f"{m[1]}{body}\n{m[2]}", text, flags=re.S)
        if count != 1:
            sys.exit(f"{path} has no place for the table {name}: <!-- {name} --> … <!-- end -->")
        path.write_text(text)
