#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the picture of the page "In Python": four poses of its arm. It needs the package, trimesh and PyVista.

usage: python_picture.py FILE.png
"""
import pathlib
import re
import sys

import numpy
import pyvista

PAGE = pathlib.Path(__file__).resolve().parent.parent.parent / "common/python/README.md"


def main():
    code = re.search(r"## Pose an arm\n.*?```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]
    names = {}
    exec(code.replace('bent.export("bent.ply")', ""), names)  # pylint: disable=exec-used
    faces = numpy.insert(numpy.asarray(names["arm"].faces), 0, 3, axis=1).ravel()
    plotter = pyvista.Plotter(off_screen=True, window_size=(900, 400))
    plotter.set_background("white")
    for k in range(4):
        plotter.add_mesh(pyvista.PolyData(names["editor"].pose(k / 3) + [2.4 * k, 0, 0], faces), color="#d8b48c", smooth_shading=True)
    plotter.view_xz()
    plotter.enable_parallel_projection()
    plotter.camera.focal_point, plotter.camera.position = (4.5, 0, 2.4), (4.5, -20, 2.4)
    plotter.camera.parallel_scale = 2.6
    plotter.screenshot(sys.argv[1])


if __name__ == "__main__":
    main()
