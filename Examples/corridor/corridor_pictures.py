# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the echoes of the door, the stairwell and the corridor, seen from the lidar, as in the paper, Fig. 13-15.
The colour of a dot is its energy. Nearer dots are larger."""
import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers VTK's factories)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import (vtkActor, vtkGlyph3DMapper, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

import avianlidar as al
import tools
from avianlidar._cloud import vertices

# Pale colours of the materials of Table 1.
FACES = {0: (0.95, 0.95, 0.94), 1: (0.78, 0.87, 0.93), 2: (0.72, 0.72, 0.75), 3: (0.90, 0.82, 0.70)}

# Name, title, point in the middle of the view (m), height of the view (deg). The lidar is the eye.
AREAS = (("door", "The door, its window and the hydrant cabinet", (-3.5, 0, 1.3), 42),
         ("stairwell", "The stairwell with its handrail", (0.75, -4.2, 1.35), 50),
         ("corridor", "The corridor and its bulletin board", (24, 0.6, 1.3), 66))


class View:
    """A view of surfaces, lines and dots in perspective, as an image for Matplotlib."""

    def __init__(self, width=1150, height=800):
        self.renderer, self.window = vtkRenderer(), vtkRenderWindow()
        self.renderer.SetBackground(1, 1, 1)
        self.window.SetOffScreenRendering(True)
        self.window.SetMultiSamples(8)
        self.window.SetSize(width, height)
        self.window.AddRenderer(self.renderer)

    def show(self, data, colour=(0, 0, 0), width=1.2, mapper=None):
        """Draws data in one colour or, with a mapper, in the colours of the mapper's scalars."""
        if mapper is None:
            mapper = vtkPolyDataMapper()
            mapper.ScalarVisibilityOff()
            mapper.SetResolveCoincidentTopologyToPolygonOffset()
        mapper.SetInputData(data)
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        actor.GetProperty().SetColor(*colour)
        actor.GetProperty().SetLineWidth(width)
        self.renderer.AddActor(actor)
        return actor

    def dots(self, points, colours, diameters):
        """Draws balls at points (m). @param colours rows of 3 bytes @param diameters one, or one for each point, m"""
        data, ball, mapper = vertices(points), vtkSphereSource(), vtkGlyph3DMapper()
        sizes = np.broadcast_to(diameters, len(points)).astype(float)
        for name, values in (("rgb", np.asarray(colours, np.uint8)), ("size", sizes)):
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            data.GetPointData().AddArray(array)
        ball.SetThetaResolution(12)
        mapper.SetSourceConnection(ball.GetOutputPort())
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("rgb")
        mapper.SetColorModeToDirectScalars()
        mapper.OrientOff()
        mapper.SetScaleModeToScaleByMagnitude()
        mapper.SetScaleArray("size")
        self.show(data, mapper=mapper)

    def image(self, eye, target, angle):
        """The view from the point `eye` as rows of pixels. @param angle height of the view, deg"""
        camera, grab = self.renderer.GetActiveCamera(), vtkWindowToImageFilter()
        camera.SetPosition(*eye)
        camera.SetFocalPoint(*target)
        camera.SetViewUp(0, 0, 1)
        camera.SetViewAngle(angle)
        self.renderer.ResetCameraClippingRange()
        self.window.Render()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.Update()
        width, height, _ = grab.GetOutput().GetDimensions()
        pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(height, width, -1)
        pixels = pixels[::-1, :, :3].copy()
        self.window.Finalize()
        return pixels


def area_view(file, scene, echoes, title, target, angle):
    eye, view = np.array(echoes.fields["position"]), View()
    for i in range(scene.GetNumberOfBlocks()):
        block = scene.GetBlock(i)
        view.show(block, FACES.get(int(block.GetCellData().GetArray("material_id").GetTuple1(0)), FACES[0]))
        view.show(tools.edges(block, 40), (0.3, 0.3, 0.3))
    if echoes.number_of_points:
        # Dots are shifted a little towards the eye, so that surfaces do not cut the dots.
        view.dots(eye + 0.9 * (echoes.points - eye), echoes["rgb"], 0.025 * np.sqrt(echoes["distance_m"]))
    with tools.figure(file, figsize=(13, 8.5)) as axes:
        axes.imshow(view.image(eye, target, angle))
        axes.set_axis_off()
        axes.set_title(title, loc="left")
        low, high = (1e6 * echoes.fields[name] for name in ("lower_energy_limit", "upper_energy_limit"))
        bar = axes.scatter([], [], c=[], cmap=al.hue_colors(), vmin=low, vmax=high)
        axes.figure.colorbar(bar, ax=axes, label="energy (µJ)", shrink=0.6)


def draw(scene, scan, echoes, built, options):
    """Writes door.png, stairwell.png, corridor.png (only for the built scene), top.png and range.png."""
    words = f"C16, {options.rays} rays per beam"
    if built:
        for name, title, target, angle in AREAS:
            file = options.out / f"{name}.png"
            area_view(file, scene, echoes, f"{title}, seen from the lidar; {words}", target, angle)
    with tools.figure(options.out / "top.png", figsize=(13, 5)) as axes:
        tools.from_above(axes, scene, echoes, tools.extent(scene, echoes, 0.05), f"From above, {words}", scan=scan)
    tools.range_images(options.out / "range.png", scan, words)
