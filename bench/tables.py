#!/usr/bin/env python3
"""Puts the figures of bench/results/*.json into the tables of docs/performance.md.

    fascia bench paper --json > bench/results/paper.json      (likewise scaling, sheet, peers)
    fascia_bench --benchmark_repetitions=5 --benchmark_format=json > bench/results/kernels.json
    bench/tables.py
"""

import json
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent


def table(head, rows):
    lines = [head, ["---"] * len(head)] + rows
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def percent(share):
    return f"{100 * share:.0f}"


def paper(results):
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

    return table(head, [row(r) for r in results])


def scaling(results):
    head = ["points", "threads", "× real time", "ms per frame", "steps per frame",
            "ns per point and step", "forces %", "constraints %", "other %", "bytes per point",
            "deepest, mm", "largest stretch"]
    return table(head, [[
        r["points"], r["threads"], f"{r['realtime_ratio']:.1f}", f"{1e3 * r['frame_s']:.3f}",
        f"{r['steps_per_frame']:.0f}", f"{r['ns_per_point_and_step']:.1f}",
        percent(r["share_forces"]), percent(r["share_constraints"]), percent(r["share_other"]),
        f"{r['bytes_per_point']:.0f}", f"{1e3 * r['max_penetration_m']:.4f}",
        f"{r['max_edge_stretch']:.2f}"] for r in results])


def sheet(results):
    head = ["points", "scheme", "steps", "threads", "× real time", "median",
            "stretch, largest / 99th percentile", "deepest, mm", "lost points"]
    return table(head, [[
        r["points"], r["engine"], r["setting"], r["threads"], f"{r['realtime_ratio']:.1f}",
        f"{r['realtime_ratio_median']:.1f}",
        f"{100 * r['stretch_max']:.1f} / {100 * r['stretch_p99']:.1f} %",
        f"{1e3 * r['penetration_m']:.2f}", f"{r['lost_points']:.0f}"] for r in results])


def peers(results):
    head = ["points", "engine", "setting", "× real time", "stretch, largest / 99th percentile",
            "deepest, mm", "times Bullet"]
    return table(head, [[
        r["points"], r["engine"], r["setting"], f"{r['realtime_ratio']:.2f}",
        f"{100 * r['stretch_max']:.1f} / {100 * r['stretch_p99']:.1f} %",
        f"{1e3 * r['penetration_m']:.1f}",
        f"**{r['times_bullet']:.1f}**" if "times_bullet" in r else ""] for r in results])


def kernels(results):
    return table(["kernel / columns / rows", "ns per point"], [[
        b["run_name"], f"{1e9 * b['s_per_point']:.1f}"]
        for b in results if b.get("aggregate_name") == "median" and "s_per_point" in b])


def main():
    page = ROOT / "docs" / "performance.md"
    text = page.read_text()
    for name, render in (("paper", paper), ("scaling", scaling), ("sheet", sheet),
                         ("peers", peers), ("kernels", kernels)):
        file = ROOT / "bench" / "results" / f"{name}.json"
        if not file.exists():
            continue
        document = json.loads(file.read_text())
        body = render(document.get("results") or document["benchmarks"])
        pattern = rf"(<!-- {name} -->\n).*?(<!-- end -->)"
        text = re.sub(pattern, lambda m, b=body: f"{m[1]}{b}\n{m[2]}", text, flags=re.S)
    page.write_text(text)


if __name__ == "__main__":
    main()
