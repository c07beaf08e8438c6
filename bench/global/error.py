"""The error of pictures from pairs of them: error.py, then lines `A B` on stdin, .exr or .npy; answers each with a number.

Two pictures of one renderer with different seeds have independent errors, so half the mean square of their difference is the mean square error of
each, without any reference. Relative: each square over that of the pair's mean plus 0.01. The worst thousandth is left out: a single path through a
caustic would be most of it.
"""

import sys

import mitsuba
import numpy

mitsuba.set_variant("scalar_rgb")


def load(path):
    if path.endswith(".npy"):
        return numpy.load(path)[..., :3].astype(numpy.float64)
    bitmap = mitsuba.Bitmap(path)
    names = [bitmap.struct_()[i].name for i in range(bitmap.channel_count())]
    pixels = numpy.array(bitmap, dtype=numpy.float64)
    return pixels[..., [names.index(name) for name in ("R", "G", "B")]]


for line in sys.stdin:
    a, b = (load(path) for path in line.split())
    squares = (a - b) ** 2 / 2 / (((a + b) / 2) ** 2 + 0.01)
    kept = numpy.sort(squares.ravel())[: int(squares.size * 0.999)]
    print(kept.mean(), (a + b).mean() / 2, flush=True)
