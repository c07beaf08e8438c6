"""How far pictures of one size are apart: compare.py PICTURE OTHER. Prints the pixels with a channel off by more than 16."""

import sys

import numpy
from PIL import Image

MOST = 16
one, other = (numpy.asarray(Image.open(path).convert("RGB"), dtype=numpy.int16) for path in sys.argv[1:])
print(int((abs(one - other).max(2) > MOST).sum()), one.shape[0] * one.shape[1])
