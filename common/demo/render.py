#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders meshes side by side into one PNG, all seen by the same camera, so that they can be compared by eye.

Needs an X server (xvfb-run) and the Debian package python3-vtk9. Meshes are PLY files.
"""
import argparse

import numpy
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (registers the text renderer)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the renderer)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkPolyDataNormals
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkTextActor, vtkWindowToImageFilter)

SURFACE = (0.80, 0.81, 0.84)
# By vertex class: fixed grey, and the colours of the paper's Figure 3; then seven for neighbouring cells.
CLASS_COLOURS = numpy.array([(196, 196, 200), (214, 64, 56), (110, 190, 110), (250, 215, 30),
                             (117, 170, 219), (240, 178, 106), (140, 200, 150), (222, 134, 134), (180, 156, 214),
                             (236, 220, 120), (160, 160, 160)], dtype=numpy.uint8)
HANDLE = 3
CAPTION = 0.09  # fraction of a panel's height
# Direction from the eye's point of view (right, up, towards the eye) and brightness. The main light grazes the surface
# so that small detail throws shade.
LIGHTS = [((-0.8, 0.9, 0.45), 0.78), ((0.9, 0.1, 0.6), 0.32), ((0, 0, 1), 0.2)]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", help="PNG to write")
    parser.add_argument("--panel", dest="panels", action="append", nargs="+", required=True,
                        metavar=("MESH CAPTION", "CLASSES"),
                        help="a PLY file, the text below it, and a text file with one class per vertex "
                             "(0 fixed, 1 anchor, 2 free, 3 handle, 4 to 10 cells) to colour it by")
    parser.add_argument("--toward", type=float, nargs=3, default=(0.35, -0.8, 0.6), metavar=("X", "Y", "Z"),
                        help="direction from the mesh to the eye")
    parser.add_argument("--up", type=float, nargs=3, default=(0, 0, 1), metavar=("X", "Y", "Z"))
    parser.add_argument("--around", type=float, nargs=4, metavar=("X", "Y", "Z", "RADIUS"),
                        help="show this part; by default everything in all meshes fits")
    parser.add_argument("--height", type=int, default=420, help="of the panels, pixels")
    parser.add_argument("--columns", type=int, default=0, help="panels per row; 0: all in one row")
    parser.add_argument("--flat", action="store_true", help="shade triangles, not vertices")
    given = parser.parse_args()
    if any(len(panel) not in (2, 3) for panel in given.panels):
        parser.error("--panel takes MESH CAPTION [CLASSES]")
    return given


def read_mesh(path):
    reader = vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    if mesh.GetNumberOfPoints() == 0 or mesh.GetNumberOfPolys() == 0:
        raise SystemExit(f"render.py: {path} is not a PLY file with faces.")
    mesh.GetPointData().Initialize()  # colours and normals of the file would take over
    return mesh


def points_of(mesh):
    return vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)


def used_points(mesh):
    """Without those that no face uses: they are not drawn."""
    return points_of(mesh)[numpy.unique(vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()))]


class View:
    """A parallel projection that all panels share."""

    def __init__(self, meshes, toward, up, around, height):
        self.toward = numpy.array(toward, float) / numpy.linalg.norm(toward)
        right = numpy.cross(up, self.toward)
        right /= numpy.linalg.norm(right)
        self.up = numpy.cross(self.toward, right)
        frame = numpy.array([right, self.up, self.toward])
        seen = numpy.vstack([used_points(mesh) for mesh in meshes]) @ frame.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        self.depth = high[2] - low[2]
        if around:
            middle = frame @ numpy.array(around[:3])
            low, high = middle - around[3], middle + around[3]
        self.scale = max((high[1] - low[1]) / 2, (high[0] - low[0]) / 5) * 1.04
        self.focus = (low + high) / 2 @ frame
        shown = height * (1 - CAPTION)
        self.width = int(shown * numpy.clip((high[0] - low[0]) * 0.53 / self.scale, 0.6, 2.5))

    def apply(self, renderer):
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(self.scale)
        camera.SetFocalPoint(*self.focus)
        camera.SetPosition(*(self.focus + (2 * self.depth + self.scale) * self.toward))
        camera.SetViewUp(*self.up)
        renderer.ResetCameraClippingRange()


def surface_actor(mesh, classes, flat):
    if classes is not None:
        colours = numpy_to_vtk(CLASS_COLOURS[classes], deep=True)
        mesh.GetPointData().SetScalars(colours)
    normals = vtkPolyDataNormals()
    normals.SetInputData(mesh)
    normals.SplittingOff()
    normals.ConsistencyOff()
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.SetScalarVisibility(classes is not None)
    actor = vtkActor()
    actor.SetMapper(mapper)
    style = actor.GetProperty()
    style.SetColor(*SURFACE)
    style.SetAmbient(0.1)
    style.SetSpecular(0.12)
    style.SetSpecularPower(25)
    style.SetInterpolationToFlat() if flat else style.SetInterpolationToPhong()
    return actor


def handle_actor(centres, radius):
    """A few single vertices would not be seen: balls on them."""
    together = vtkAppendPolyData()
    for centre in centres:
        ball = vtkSphereSource()
        ball.SetCenter(*centre)
        ball.SetRadius(radius)
        ball.SetThetaResolution(24)
        ball.SetPhiResolution(16)
        together.AddInputConnection(ball.GetOutputPort())
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(together.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*(CLASS_COLOURS[HANDLE] / 255))
    actor.GetProperty().SetAmbient(0.3)
    return actor


def caption_renderer(caption, font_size):
    text = vtkTextActor()
    text.SetInput(caption)
    style = text.GetTextProperty()
    style.SetFontSize(font_size)
    style.SetColor(0.1, 0.1, 0.1)
    style.SetJustificationToCentered()
    style.SetVerticalJustificationToCentered()
    text.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    text.SetPosition(0.5, 0.5)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor2D(text)
    return renderer


def mesh_renderer(mesh, classes, view, flat):
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AutomaticLightCreationOff()
    for direction, brightness in LIGHTS:
        light = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*direction)
        light.SetFocalPoint(0, 0, 0)
        light.SetIntensity(brightness)
        renderer.AddLight(light)
    renderer.AddActor(surface_actor(mesh, classes, flat))
    if classes is not None:
        handles = points_of(mesh)[classes == HANDLE]
        if 0 < len(handles) <= 50:
            renderer.AddActor(handle_actor(handles, 0.025 * view.scale))
    view.apply(renderer)
    return renderer


def main():
    given = arguments()
    meshes = [read_mesh(entry[0]) for entry in given.panels]
    view = View(meshes, given.toward, given.up, given.around, given.height)
    columns = given.columns or len(meshes)
    rows = -(-len(meshes) // columns)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(columns * view.width, rows * given.height)
    paper = vtkRenderer()  # where the last row has no panel
    paper.SetBackground(1, 1, 1)
    window.AddRenderer(paper)
    for number, (mesh, entry) in enumerate(zip(meshes, given.panels)):
        classes = numpy.loadtxt(entry[2], dtype=int) if len(entry) == 3 else None
        if classes is not None and len(classes) != mesh.GetNumberOfPoints():
            raise SystemExit(f"render.py: {entry[2]} has {len(classes)} lines, {entry[0]} has "
                             f"{mesh.GetNumberOfPoints()} vertices.")
        column, row = number % columns, rows - 1 - number // columns
        left, right, low, high = column / columns, (column + 1) / columns, row / rows, (row + 1) / rows
        middle = low + CAPTION / rows
        picture = mesh_renderer(mesh, classes, view, given.flat)
        picture.SetViewport(left, middle, right, high)
        caption = caption_renderer(entry[1], max(12, given.height // 20))
        caption.SetViewport(left, low, right, middle)
        window.AddRenderer(picture)
        window.AddRenderer(caption)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetCompressionLevel(9)
    writer.SetFileName(given.output)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main()
