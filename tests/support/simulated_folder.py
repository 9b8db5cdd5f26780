# SPDX-License-Identifier: Apache-2.0
"""Reads what `plvo simulate --out` wrote, without plvo's reader."""
import numpy as np
from PIL import Image


class SimulatedFolder:
    """numbers: of calibration.txt. frames: (stamp of colour in ns, RGB (height, width, 3), stamp of depth in ns, depth (height, width) in
    numbers[4] units a metre)."""

    def __init__(self, folder):
        self.folder = folder
        self.numbers = [float(x) for x in self.rows("calibration.txt")[0]]
        self.frames = []
        for colour, depth in zip(self.rows("rgb.txt"), self.rows("depth.txt")):
            rgb = np.asarray(Image.open(folder / colour[1]).convert("RGB"))
            units = np.asarray(Image.open(folder / depth[1])).astype(np.uint16)
            self.frames.append((self.ns(colour[0]), rgb, self.ns(depth[0]), units))

    def rows(self, name):
        lines = (self.folder / name).read_text().splitlines()
        return [line.split() for line in lines if line and not line.startswith("#")]

    @staticmethod
    def ns(stamp):
        seconds, _, rest = stamp.partition(".")
        return int(seconds) * 10**9 + int(rest.ljust(9, "0")[:9])
