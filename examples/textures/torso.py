#!/usr/bin/env python3
"""Paints examples/torso.png, the hide of the strongman.

    python3 examples/textures/torso.py [OUT.png]

Only the standard library is needed. Everything is painted in the skin's own coordinates. The skin is
a tube from the left wrist (v = 0) to the right wrist (v = 1); u runs around it: 0 the middle of the
back, 0.25 underneath, 0.5 the front, 0.75 on top. Where things are:

    v   wrist 0 | elbow 0.17 | biceps 0.25 | shoulder 0.33 | breastbone 0.50 | ... | right wrist 1
    u   at v = 0.5:  navel 0.30 | ribs 0.36 | below the pectorals 0.42 | nipples 0.47 | throat 0.73
"""
import math
import os
import random
import struct
import sys
import zlib

WIDTH, HEIGHT = 1024, 512

SKIN = (226, 164, 133)
LIGHT = (238, 184, 153)
RED = (214, 122, 98)
SHADE = (178, 106, 80)
NIPPLE = (176, 98, 84)
HAIR = (74, 46, 33)
INK = (46, 66, 96)
HEART = (186, 46, 52)

SPAN = 1.56  # metres from wrist to wrist

# Height above the ground of the trunk's outline, once around, from the back over the belly.
OUTLINE = [(0.0, 0.75), (0.06, 0.71), (0.12, 0.67), (0.16, 0.63), (0.19, 0.59), (0.22, 0.54),
           (0.25, 0.45), (0.28, 0.44), (0.31, 0.57), (0.34, 0.62), (0.41, 0.645), (0.44, 0.67),
           (0.50, 0.74), (0.56, 0.80), (0.62, 0.83), (0.72, 0.87), (0.75, 0.92), (0.78, 1.02),
           (0.81, 0.93), (0.84, 0.89), (0.91, 0.84), (1.0, 0.75)]


def height(u):
    for (a, ya), (b, yb) in zip(OUTLINE, OUTLINE[1:]):
        if u <= b:
            return ya + (yb - ya) * (u - a) / (b - a)
    return OUTLINE[-1][1]


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def smooth(low, high, x):
    """0 below low, 1 above high, an S between."""
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def dab(x, y, x0, y0, rx, ry):
    """A soft Gaussian spot."""
    return math.exp(-(((x - x0) / rx) ** 2) - ((y - y0) / ry) ** 2)


def groove(d, width):
    """A soft line at distance d."""
    return math.exp(-((d / width) ** 2))


def segment(x, y, ax, ay, bx, by):
    """Distance from a line segment."""
    dx, dy = bx - ax, by - ay
    t = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
    return math.hypot(x - ax - t * dx, y - ay - t * dy)


class Noise:
    """Smooth random hills that meet at u = 0 and 1."""

    def __init__(self, columns, rows, seed):
        dice = random.Random(seed)
        self.columns, self.rows = columns, rows
        self.grid = [[dice.uniform(-1, 1) for _ in range(columns)] for _ in range(rows + 2)]

    def at(self, u, v):
        x, y = u * self.columns, v * self.rows
        i, j = int(x), int(y)
        s, t = smooth(0, 1, x - i), smooth(0, 1, y - j)
        k, i = (i + 1) % self.columns, i % self.columns
        low = self.grid[j][i] + (self.grid[j][k] - self.grid[j][i]) * s
        high = self.grid[j + 1][i] + (self.grid[j + 1][k] - self.grid[j + 1][i]) * s
        return low + (high - low) * t


HILLS = [(Noise(6, 12, 1), 0.6), (Noise(19, 40, 2), 0.4)]


def chest_hair():
    """Short strokes, as (x, y, x, y) in metres: a tuft between the pectorals."""
    dice = random.Random(7)
    strokes = []
    for _ in range(190):
        x, y = dice.gauss(0, 0.03), dice.gauss(0.74, 0.025)
        turn = dice.uniform(-0.9, 0.9) - 12 * x
        length = dice.uniform(0.008, 0.016)
        strokes.append((x, y, x + length * math.sin(turn), y - length * math.cos(turn)))
    return strokes


STROKES = chest_hair()


def front(x, y, color):
    """Chest and belly at x metres to its left and y metres above the ground."""
    side = abs(x)
    # Under the pectorals, between them, and the furrow from there to the navel.
    under = 0.652 + 1.1 * (side - 0.10) ** 2
    dark = 0.75 * groove(y - under, 0.012) * smooth(0.235, 0.17, side) * smooth(0.0, 0.03, side)
    dark += 0.55 * groove(side, 0.009) * smooth(0.64, 0.67, y) * smooth(0.84, 0.78, y)
    belly = smooth(0.43, 0.46, y) * smooth(0.655, 0.63, y)
    dark += 0.55 * groove(side, 0.008) * belly * smooth(0.46, 0.5, y)
    # Six-pack: three furrows across, one down each side.
    for furrow in (0.617, 0.577):
        dark += 0.5 * groove(y - furrow - 2 * side * side, 0.009) * smooth(0.105, 0.08, side) * belly
    dark += 0.5 * groove(side - 0.1 + 0.25 * (0.6 - y), 0.011) * belly
    # Ribs fan out beside it.
    for k in range(3):
        line = 0.6 - 0.045 * k + 0.5 * (side - 0.12)
        dark += 0.3 * groove(y - line, 0.009) * smooth(0.12, 0.14, side) * smooth(0.2, 0.17, side)
    # Collar bones.
    dark += 0.35 * groove(y - 0.835 - 0.16 * side, 0.012) * smooth(0.02, 0.05, side) * smooth(
        0.22, 0.16, side)
    color = mix(color, SHADE, min(0.85, dark))
    color = mix(color, LIGHT, 0.5 * dab(side, y, 0.1, 0.765, 0.06, 0.035))
    color = mix(color, RED, 0.35 * dab(side, y, 0.12, 0.69, 0.07, 0.03))
    # Nipples and navel.
    d = math.hypot(side - 0.125, y - 0.708)
    color = mix(color, NIPPLE, 0.9 * smooth(0.021, 0.015, d))
    color = mix(color, SHADE, 0.6 * smooth(0.009, 0.005, d))
    d = math.hypot(x, y - 0.55)
    color = mix(color, mix(SHADE, HAIR, 0.6), 0.9 * smooth(0.013, 0.007, d))
    if side < 0.12 and 0.63 < y < 0.84:
        d = min(segment(x, y, *stroke) for stroke in STROKES)
        color = mix(color, HAIR, 0.55 * smooth(0.0019, 0.0007, d))
    return color


def back(x, y, color):
    side = abs(x)
    dark = 0.6 * groove(side, 0.011) * smooth(0.44, 0.5, y) * smooth(0.9, 0.84, y)
    blade = math.hypot((side - 0.1) / 0.8, y - 0.77)
    dark += 0.4 * groove(blade - 0.085, 0.013) * smooth(0.79, 0.72, y)
    dark += 0.35 * groove(y - 0.56 - 0.5 * side, 0.014) * smooth(0.2, 0.14, side)
    return mix(color, SHADE, min(0.8, dark))


def anchor(a, b):
    """Ink of an anchor; a metres towards its ring, b across."""
    line = 0.0042
    d = segment(a, b, -0.03, 0, 0.022, 0)
    d = min(d, segment(a, b, 0.012, -0.014, 0.012, 0.014))
    d = min(d, abs(math.hypot(a - 0.03, b) - 0.0075))
    bow = math.hypot(a + 0.002, b) - 0.029
    if a < -0.012:
        d = min(d, abs(bow))
    for s in (-1, 1):
        d = min(d, segment(a, b, -0.012, s * 0.027, -0.022, s * 0.019) - 0.001)
        d = min(d, segment(a, b, -0.012, s * 0.027, -0.014, s * 0.036) - 0.001)
        d = min(d, segment(a, b, -0.006, s * 0.027, -0.012, s * 0.027) - 0.002)
    return smooth(line, line - 0.002, d)


def heart(a, b):
    """Distance from a heart's outline, negative inside; its point towards the hand."""
    size = 0.046
    x, y = abs(b) / size, a / size + 0.55
    if x + y > 1:
        return size * (math.hypot(x - 0.25, y - 0.75) - math.sqrt(2) / 4)
    nearest = max(x + y, 0) / 2
    d = min(math.hypot(x, y - 1), math.hypot(x - nearest, y - nearest))
    return size * math.copysign(d, x - y)


def color_at(u, v):
    x, y = SPAN * (0.5 - v), height(u)
    side = abs(x)
    tone = sum(share * hills.at(u, v) for hills, share in HILLS)
    color = mix(SKIN, LIGHT if tone > 0 else RED, 0.28 * abs(tone))
    # Sun on top, warm underneath; red elbows and shoulders.
    color = mix(color, LIGHT, 0.3 * groove(abs(u - 0.72), 0.12))
    color = mix(color, RED, 0.35 * groove(min(abs(u - 0.22), 1), 0.1))
    color = mix(color, RED, 0.3 * groove(side - 0.3, 0.07) * smooth(0.5, 0.75, u))
    color = mix(color, RED, 0.3 * groove(side - 0.5, 0.04))
    trunk = smooth(0.3, 0.22, side)
    if trunk > 0:
        painted = front(x, y, color) if 0.25 < u < 0.77 else back(x, y, color)
        color = mix(color, painted, trunk)
    # The arms: furrows between deltoid and biceps, around the elbow's crook.
    around = (u - 0.62) * 0.5
    dark = 0.4 * groove(side - 0.325 - 0.35 * abs(u - 0.56), 0.012) * groove(u - 0.58, 0.12)
    color = mix(color, SHADE, dark)
    along = (side - 0.36) * -0.78
    if x > 0:
        color = mix(color, INK, 0.88 * anchor(along, around))
    else:
        d = heart(along, around)
        color = mix(color, HEART, 0.85 * smooth(0.001, -0.001, d))
        color = mix(color, INK, 0.85 * smooth(0.0035, 0.0015, abs(d)))
    return color


def paint():
    rows = []
    for j in range(HEIGHT):
        v = 1 - (j + 0.5) / HEIGHT
        row = bytearray([0])
        for i in range(WIDTH):
            color = color_at((i + 0.5) / WIDTH, v)
            row += bytes(int(min(255, max(0, c + 0.5))) for c in color)
        rows.append(bytes(row))
    return rows


def write_png(path, rows):
    def chunk(tag, data):
        body = tag + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    # Filter 2, each byte less the one above it, packs soft colours well.
    packed, above = bytearray(), bytes(3 * WIDTH)
    for row in rows:
        line = row[1:]
        packed += b"\x02" + bytes((a - b) & 255 for a, b in zip(line, above))
        above = line
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                   + chunk(b"IDAT", zlib.compress(bytes(packed), 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    write_png(sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "..", "torso.png"), paint())
