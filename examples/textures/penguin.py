#!/usr/bin/env python3
"""Paints examples/penguin.png, the plumage of the penguin.

    python3 examples/textures/penguin.py [OUT.png]

Only the standard library is needed. Everything is painted in the skin's own coordinates: u runs
around the body (0.5 is the front, 0 and 1 meet at the back), v runs from the feet (0) to the
crown (1). Where things are on the penguin:

    crown 1.00 | eyes 0.81 | beak 0.73 | throat 0.69 | flippers 0.60 | waist 0.50 | thighs 0.20
"""
import math
import os
import struct
import sys
import zlib

WIDTH, HEIGHT = 1024, 512

COAT = (37, 41, 54)  # blue-black
COAT_SHEEN = (70, 80, 104)
WHITE = (250, 246, 236)
CREAM = (240, 226, 202)
GOLD = (255, 196, 66)
ORANGE = (250, 140, 30)
ROSE = (250, 150, 138)


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def smooth(low, high, x):
    """0 below low, 1 above high, an S between."""
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def dab(a, v, a0, v0, radius_a, radius_v):
    """A soft Gaussian spot."""
    return math.exp(-(((a - a0) / radius_a) ** 2) - ((v - v0) / radius_v) ** 2)


class Noise:
    """Smooth random hills, columns x rows of them, that meet at u = 0 and 1."""

    def __init__(self, columns, rows, seed):
        state = seed
        self.columns, self.rows, self.grid = columns, rows, []
        for _ in range(columns * (rows + 1)):
            state = (state * 1103515245 + 12345) % 2**31
            self.grid.append(state / 2**30 - 1)

    def at(self, u, v):
        x, y = u % 1.0 * self.columns, min(max(v, 0.0), 0.999999) * self.rows
        i, j = int(x), int(y)
        s, t = x - i, y - j
        s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
        i, k = i % self.columns, (i + 1) % self.columns
        low, high = j * self.columns, (j + 1) * self.columns
        bottom = self.grid[low + i] + (self.grid[low + k] - self.grid[low + i]) * s
        top = self.grid[high + i] + (self.grid[high + k] - self.grid[high + i]) * s
        return bottom + (top - bottom) * t


def curve(points, x):
    """A smooth line through (x, y) points, flat at each of them."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x < x1:
            return y0 + (y1 - y0) * smooth(x0, x1, x)
    return points[-1][1]


# Half the width of the white front, in u, from the feet to the throat.
FRONT = [(0.00, 0.20), (0.10, 0.19), (0.33, 0.170), (0.55, 0.150), (0.70, 0.070), (0.76, 0.10)]


def ellipse(a, v, a0, v0, radius_a, radius_v):
    """Positive inside; about the distance to the rim, in units of u."""
    return (1 - math.hypot((a - a0) / radius_a, (v - v0) / radius_v)) * min(radius_a, radius_v)


def white_front(a, v):
    """Positive on the white parts: belly and a heart-shaped face."""
    belly = curve(FRONT, v) - a if v < 0.74 else -1
    face = max(ellipse(a, v, 0.080, 0.815, 0.079, 0.078), ellipse(a, v, 0.0, 0.755, 0.150, 0.055))
    # A smooth union: the two melt together where they are about as near.
    k = 0.02
    h = max(k - abs(belly - face), 0) / k
    return max(belly, face) + h * h * k / 4


FLUFF = Noise(110, 60, 7)
CLUMPS = Noise(34, 22, 3)


def feathers(u, v):
    """Rows of overlapping feathers: dark at each root, light at each tip. About -1 to 1."""
    rows, columns = 40, 56
    y = v * rows + 0.25 * CLUMPS.at(u, v)
    row = math.floor(y)
    x = u * columns + 0.5 * (row % 2)
    across = 2 * abs(x - math.floor(x) - 0.5)  # 1 between two feathers
    down = y - row - 0.35 * (1 - across * across)
    return 1 - 2 * (down % 1.0)


def paint(u, v):
    a = abs(u - 0.5)
    clump, fluff = CLUMPS.at(u, v), FLUFF.at(u, v)
    barb = feathers(u, v)

    sheen = 0.28 + 0.16 * clump + 0.06 * barb + 0.35 * dab(a, v, 0.33, 0.60, 0.14, 0.16)
    coat = mix(COAT, COAT_SHEEN, min(1.0, max(0.0, sheen)))

    white = mix(WHITE, CREAM, min(1.0, max(0.0, smooth(0.30, 0.02, v) * 0.8 + 0.10 + 0.10 * clump)))
    white = tuple(c * (1 + 0.012 * barb) for c in white)
    # The emperor's golden throat, brightest at the sides of the neck.
    gold = smooth(0.56, 0.69, v) * smooth(0.745, 0.71, v)
    white = mix(white, GOLD, 0.85 * gold)
    white = mix(white, ORANGE, 0.9 * dab(a, v, 0.10, 0.690, 0.05, 0.045))
    # Rosy cheeks.
    white = mix(white, ROSE, 0.75 * dab(a, v, 0.120, 0.757, 0.026, 0.024))

    # The border is ragged like down, more so on the belly than in the face.
    ragged = 0.007 if v < 0.66 else 0.004
    inside = white_front(a, v) + ragged * (0.6 * fluff + 0.4 * clump)
    return mix(coat, white, smooth(-0.004, 0.004, inside))


def png(width, height, rows):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    def filtered():
        above = bytes(3 * width)
        for row in rows:  # "up": most texels are close to the one above
            yield b"\x02" + bytes((x - y) % 256 for x, y in zip(row, above))
            above = row

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = zlib.compress(b"".join(filtered()), 9)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data)
            + chunk(b"IEND", b""))


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    out = sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "..", "penguin.png")
    rows = []
    for y in range(HEIGHT):
        v = 1 - (y + 0.5) / HEIGHT
        row = bytearray()
        for x in range(WIDTH):
            row += bytes(min(254, max(0, 2 * round(c / 2))) for c in paint((x + 0.5) / WIDTH, v))
        rows.append(bytes(row))
    with open(out, "wb") as file:
        file.write(png(WIDTH, HEIGHT, rows))


if __name__ == "__main__":
    main()
