#!/usr/bin/env python3
"""Paints examples/wombat.png, the coat of the wombat.

    python3 examples/textures/wombat.py [OUT.png]

Only the standard library is needed. Everything is painted in the skin's own coordinates: u runs
around the body (0.5 is the middle of the back, 0 and 1 meet under the belly), v runs from the
rump (0) to the nose (1). Where things are on the wombat:

    nose 1.00 | muzzle 0.95 | eyes 0.86 | ears 0.75 | neck 0.66 | shoulders 0.52 | thighs 0.25
"""
import math
import os
import random
import struct
import sys
import zlib

WIDTH, HEIGHT = 1024, 512

BACK = (88, 76, 66)  # umber
FLANK = (122, 109, 96)
BELLY = (150, 143, 132)
MUZZLE = (172, 162, 146)
ASH = (150, 140, 130)  # the grey of the hips
DARK = (64, 52, 45)
GOLD = (160, 138, 106)  # tips of the hairs
ROSE = (196, 148, 132)


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def smooth(low, high, x):
    """0 below low, 1 above high, an S between."""
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


class Noise:
    """Smooth noise in [0, 1] on columns x rows cells; columns repeat, so the seam does not show."""

    def __init__(self, columns, rows, seed):
        random.seed(seed)
        self.columns, self.rows = columns, rows
        self.values = [[random.random() for _ in range(columns)] for _ in range(rows + 2)]

    def at(self, u, v):
        x, y = (u % 1.0) * self.columns, min(max(v, 0.0), 1.0) * self.rows
        i, j = int(x), int(y)
        s, t = x - i, y - j
        s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
        low, high = self.values[j], self.values[j + 1]
        i, k = i % self.columns, (i + 1) % self.columns
        a = low[i] + (low[k] - low[i]) * s
        b = high[i] + (high[k] - high[i]) * s
        return a + (b - a) * t


# Strands: many cells around, few along. Fewer hairs go around the narrow head.
BODY_HAIR = Noise(240, 40, 1)
BODY_LOCKS = Noise(90, 24, 2)
HEAD_HAIR = Noise(140, 80, 3)
HEAD_LOCKS = Noise(70, 50, 6)
PATCHES = Noise(7, 6, 4)
SWAY = Noise(9, 10, 5)


def fur(u, v):
    """0 in the dark between the hairs, 1 on their tips."""
    side = u - 0.5
    sway = 0.035 * (SWAY.at(u, v) - 0.5)
    comb = u + sway + 0.10 * math.sin(2 * math.pi * side) * (1 - v)  # hair falls backwards and down
    body = 0.6 * BODY_HAIR.at(comb, v) + 0.4 * BODY_LOCKS.at(comb, v)
    head = 0.6 * HEAD_HAIR.at(u + sway, v) + 0.4 * HEAD_LOCKS.at(u + sway, v)
    hair = body + (head - body) * smooth(0.68, 0.80, v)
    ends = smooth(0.01, 0.07, v) * smooth(1.0, 0.94, v)  # strands would crowd where the tube closes
    return 0.5 + (hair - 0.5) * ends


def spot(u, v, u0, v0, radius_u, radius_v):
    """A soft spot on both sides of the animal: u0 counts from the middle of the back."""
    x, y = (abs(u - 0.5) - u0) / radius_u, (v - v0) / radius_v
    return math.exp(-x * x - y * y)


def color(u, v):
    down = 2 * abs(u - 0.5)  # 0 along the back, 1 under the belly
    patches = PATCHES.at(u, v)

    c = mix(BACK, FLANK, smooth(0.05, 0.55, down + 0.25 * (patches - 0.5)))
    c = mix(c, BELLY, 0.85 * smooth(0.62, 0.92, down + 0.12 * (patches - 0.5)))
    c = mix(c, ASH, 0.35 * smooth(0.28, 0.08, v) * (1 - 0.5 * down))
    c = mix(c, DARK, 0.5 * spot(u, v, 0.0, 0.45, 0.05, 0.3))  # the dark line of the back
    c = mix(c, DARK, 0.45 * smooth(0.62, 1.0, down) * smooth(0.05, 0.0, abs(v - 0.62)))

    # The face: a pale muzzle, dark around the eyes, a pale brow above them, rosy cheeks.
    c = mix(c, MUZZLE, 0.9 * smooth(0.885, 0.945, v - 0.02 * down))
    c = mix(c, MUZZLE, 0.7 * smooth(0.74, 0.82, v) * smooth(0.55, 0.8, down))
    c = mix(c, BACK, 0.6 * spot(u, v, 0.0, 0.90, 0.05, 0.06))
    c = mix(c, DARK, 0.8 * spot(u, v, 0.165, 0.865, 0.052, 0.042))
    c = mix(c, MUZZLE, 0.5 * spot(u, v, 0.125, 0.80, 0.045, 0.028))
    c = mix(c, ROSE, 0.2 * spot(u, v, 0.29, 0.845, 0.055, 0.04))

    hair = fur(u, v)
    depth = 0.34 - 0.14 * smooth(0.68, 0.80, v)
    c = mix(c, GOLD, 0.30 * smooth(0.62, 0.95, hair))
    shade = 1 - depth * smooth(0.55, 0.12, hair) + 0.10 * smooth(0.55, 0.9, hair)
    return tuple(x * shade for x in c)


def paint():
    rows = []
    for y in range(HEIGHT):
        v = 1 - (y + 0.5) / HEIGHT
        rows.append([color((x + 0.5) / WIDTH, v) for x in range(WIDTH)])
    return rows


def write_png(path, rows):
    """In steps of four levels, which no one sees and which halves the file."""

    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))

    data = bytearray()
    previous = bytes(3 * WIDTH)
    for row in rows:
        line = bytes(min(255, max(0, 4 * round(c / 4))) for pixel in row for c in pixel)
        data.append(2)  # each byte as the difference to the one above
        data += bytes((a - b) & 255 for a, b in zip(line, previous))
        previous = line
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                chunk(b"IDAT", zlib.compress(bytes(data), 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    folder = os.path.dirname(os.path.abspath(__file__))
    write_png(sys.argv[1] if len(sys.argv) > 1 else os.path.join(folder, "..", "wombat.png"),
              paint())
