# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of scenes and echoes with plain VTK: a page with a title, a view, a hue bar and a scale bar.

    picture = Picture("Terminal 1")
    picture.outlines(edges(surfaces))  # what stands, as black lines
    picture.dots(echoes, 2.0)          # echoes with an array `rgb` as dots of 2 m
    picture.look_down(bounds)          # north is up
    picture.hue_bar(2e-6, 6.25e-5)
    picture.save("terminal.png")
"""
import math

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (VTK's factories)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkActor2D, vtkGlyph3DMapper, vtkImageMapper, vtkPolyDataMapper,
                                         vtkPolyDataMapper2D, vtkRenderer, vtkRenderWindow, vtkTextActor,
                                         vtkWindowToImageFilter)

from avianlidar.vtkAvianLidar import vtkAvianLidarHSBColorMap

BLACK, GREY, PALE = (0, 0, 0), (0.45, 0.45, 0.45), (0.93, 0.93, 0.93)


def hue_colors(energies, low, high):
    """The colours of paper, Eq. 13, as bytes; what is not a number is nearly white."""
    colors, table = vtkAvianLidarHSBColorMap(), vtkLookupTable()
    colors.SetEnergyRange(low, high)
    colors.FillLookupTable(table)
    rgba = table.MapScalars(numpy_to_vtk(np.ascontiguousarray(energies.ravel()), deep=True), 0, -1)
    rgb = vtk_to_numpy(rgba)[:, :3].reshape(*energies.shape, 3).copy()
    rgb[np.isnan(energies)] = 242
    return rgb


def grey_colors(values, low, high):
    """From nearly black (near) to light grey (far), as bytes; what is not a number is nearly white."""
    with np.errstate(invalid="ignore"):
        grey = np.round(30 + 170 * np.clip((values - low) / max(high - low, 1e-30), 0, 1))
    grey[np.isnan(values)] = 242
    return np.repeat(grey[..., None], 3, axis=-1).astype(np.uint8)


def nice(length):
    """The largest of 1, 2, 5 times a power of ten that is not above the length."""
    power = 10 ** math.floor(math.log10(length))
    return max(f * power for f in (1, 2, 5) if f * power <= length * (1 + 1e-9))


def even_ticks(low, high):
    """Multiples of a nice step from low to high, about five; the value itself where there is but one."""
    if not high > low:
        return np.array([low])
    step = nice((high - low) / 4)
    return step * np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)


def edges(surfaces, angle=20):
    """The edges of triangles where faces end or meet at more than this angle (degrees), as lines. A face that is there
    twice, as in scenery made for looks, counts once; winding does not count."""
    places = vtk_to_numpy(surfaces.GetPoints().GetData())
    corners = np.unique(np.sort(vtk_to_numpy(surfaces.GetPolys().GetConnectivityArray()).reshape(-1, 3)), axis=0)
    normals = np.cross(places[corners[:, 1]] - places[corners[:, 0]], places[corners[:, 2]] - places[corners[:, 0]])
    areas = np.linalg.norm(normals, axis=1)
    corners, normals = corners[areas > 0], normals[areas > 0] / areas[areas > 0, None]
    pairs = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [0, 2]]])
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    pairs, normals = pairs[order], np.tile(normals, (3, 1))[order]
    first = np.flatnonzero(np.r_[True, (pairs[1:] != pairs[:-1]).any(axis=1)][:len(pairs)])
    count = np.diff(np.r_[first, len(pairs)])
    parallel = abs((normals * np.repeat(normals[first], count, axis=0)).sum(axis=1))
    drawn = pairs[first][(count == 1) | (np.minimum.reduceat(parallel, first) < math.cos(math.radians(angle)))]
    lines, cells = vtkPolyData(), vtkCellArray()
    cells.SetData(2, numpy_to_vtkIdTypeArray(np.ascontiguousarray(drawn.ravel(), dtype=np.int64), deep=True))
    lines.SetPoints(surfaces.GetPoints())
    lines.SetLines(cells)
    return lines


class Page:
    """A white window to write on, in pixels from the lower left corner."""

    def __init__(self, width, height):
        self.width, self.height = width, height
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(True)
        self.window.SetMultiSamples(8)
        self.window.SetSize(width, height)
        self.page = vtkRenderer()
        self.page.SetBackground(1, 1, 1)
        self.window.AddRenderer(self.page)

    def text(self, x, y, words, size=22, across="left", color=BLACK, bold=False, turn=0):
        actor = vtkTextActor()
        actor.SetInput(words)
        actor.SetPosition(x, y)
        actor.SetOrientation(turn)
        style = actor.GetTextProperty()
        style.SetFontFamilyToArial()
        style.SetFontSize(size)
        style.SetBold(bold)
        style.SetColor(*color)
        {"left": style.SetJustificationToLeft, "centre": style.SetJustificationToCentered,
         "right": style.SetJustificationToRight}[across]()
        style.SetVerticalJustificationToCentered()
        self.page.AddActor2D(actor)

    def line(self, points, color=BLACK, width=2):
        shape, cells, corners = vtkPolyData(), vtkCellArray(), vtkPoints()
        for x, y in points:
            corners.InsertNextPoint(x, y, 0)
        cells.InsertNextCell(len(points), range(len(points)))
        shape.SetPoints(corners)
        shape.SetLines(cells)
        mapper, actor = vtkPolyDataMapper2D(), vtkActor2D()
        mapper.SetInputData(shape)
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*color)
        actor.GetProperty().SetLineWidth(width)
        self.page.AddActor2D(actor)

    def pixels(self, x, y, colors):
        """An array of rows (the lowest first), columns and 3 bytes."""
        image, mapper, actor = vtkImageData(), vtkImageMapper(), vtkActor2D()
        image.SetDimensions(colors.shape[1], colors.shape[0], 1)
        image.GetPointData().SetScalars(numpy_to_vtk(colors.reshape(-1, 3), deep=True))
        mapper.SetInputData(image)
        mapper.SetColorWindow(255)
        mapper.SetColorLevel(127.5)
        actor.SetMapper(mapper)
        actor.SetPosition(x, y)
        self.page.AddActor2D(actor)

    def hue_bar(self, low, high, x=None, y=None, height=None, colors=hue_colors, title="energy (\u00b5J)", unit=1e-6,
                labels="{:.1f}"):
        """A bar of colours with five values; by default at the right margin."""
        height = int(height or 0.55 * self.height)
        x = self.width - 125 if x is None else x
        y = (self.height - height) // 2 if y is None else y
        values = np.linspace(low, high, height)
        self.pixels(x, y, np.repeat(colors(values, low, high)[:, None], 30, axis=1))
        for share in (0, 0.25, 0.5, 0.75, 1):
            at = y + share * (height - 1)
            self.line([(x + 30, at), (x + 37, at)])
            self.text(x + 43, at, labels.format((low + share * (high - low)) / unit), 20)
        self.text(x - 5, y + height + 26, title, 20)

    def save(self, file):
        self.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        writer = vtkPNGWriter()
        writer.SetInputConnection(grab.GetOutputPort())
        writer.SetFileName(str(file))
        writer.Write()
        self.window.Finalize()


class Picture(Page):
    """A page with a view of the scene: margins for the title (above), the scale bar (below), the hue bar (right)."""

    left, below, right, above = 20, 70, 150, 90

    def __init__(self, title, subtitle="", width=1500, height=1100):
        super().__init__(width, height)
        self.text(self.left + 5, height - 32, title, 30, bold=True)
        self.subtitle(subtitle)
        self.view = vtkRenderer()
        self.view.SetBackground(1, 1, 1)
        x0, y0, x1, y1 = self.left, self.below, width - self.right, height - self.above
        self.view.SetViewport(x0 / width, y0 / height, x1 / width, y1 / height)
        self.window.AddRenderer(self.view)
        self.line([(x0 - 1, y0 - 1), (x1 + 1, y0 - 1), (x1 + 1, y1 + 1), (x0 - 1, y1 + 1), (x0 - 1, y0 - 1)], GREY, 1)

    def subtitle(self, words):
        self.text(self.left + 5, self.height - 70, words, 20, color=GREY)

    def in_view(self, points):
        """Which of the points the view shows, were nothing in front of them."""
        aspect = (self.width - self.left - self.right) / (self.height - self.above - self.below)
        matrix = self.view.GetActiveCamera().GetCompositeProjectionTransformMatrix(aspect, -1, 1)
        rows = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
        x, y, _, w = rows @ np.column_stack([points, np.ones(len(points))]).T
        return (w > 0) & (abs(x) <= w) & (abs(y) <= w)

    def show(self, mapper, color, width=1.0, opacity=1.0):
        """Anything that a mapper draws, without shading; colours of the mapper's scalars go before the color."""
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        actor.GetProperty().SetColor(*color)
        actor.GetProperty().SetLineWidth(width)
        actor.GetProperty().SetOpacity(opacity)
        self.view.AddActor(actor)
        return actor

    @classmethod
    def for_bounds(cls, title, subtitle, bounds, height=1100):
        """As wide as a view from above of these bounds wants it to be, within reason."""
        shape = (bounds[1] - bounds[0]) / max(bounds[3] - bounds[2], 1e-6)
        across, up = cls.left + cls.right, cls.above + cls.below
        width = int(min(max(shape * (height - up) + across, 1000), 1800))
        return cls(title, subtitle, width, int(min(max((width - across) / shape + up, 500), height)))

    def faces(self, surfaces, color=PALE):
        """Surfaces in one colour, a little behind lines that lie on them."""
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(surfaces)
        mapper.ScalarVisibilityOff()
        mapper.SetResolveCoincidentTopologyToPolygonOffset()
        return self.show(mapper, color)

    def outlines(self, lines, color=BLACK, width=1.2):
        """Lines as edges() makes them."""
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(lines)
        return self.show(mapper, color, width)

    def dots(self, echoes, diameter):
        """Echoes in their colours `rgb`; the diameter in metres is a number or the name of an array."""
        ball = vtkSphereSource()
        ball.SetRadius(0.5)
        ball.SetThetaResolution(12)
        ball.SetPhiResolution(9)
        mapper = vtkGlyph3DMapper()
        mapper.SetInputData(echoes)
        mapper.SetSourceConnection(ball.GetOutputPort())
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("rgb")
        mapper.SetColorModeToDirectScalars()
        mapper.OrientOff()
        if isinstance(diameter, str):
            mapper.SetScaleModeToScaleByMagnitude()
            mapper.SetScaleArray(diameter)
        else:
            mapper.SetScaleModeToNoDataScaling()
            mapper.SetScaleFactor(diameter)
        return self.show(mapper, BLACK)

    def lidar(self, position, size):
        """A red plus, as in paper, Fig. 16."""
        x, y, z = position
        shape, cells, corners = vtkPolyData(), vtkCellArray(), vtkPoints()
        for dx, dy in ((-size, 0), (size, 0), (0, -size), (0, size)):
            corners.InsertNextPoint(x + dx, y + dy, z)
        for ends in ((0, 1), (2, 3)):
            cells.InsertNextCell(2, ends)
        shape.SetPoints(corners)
        shape.SetLines(cells)
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(shape)
        return self.show(mapper, (0.85, 0, 0), 4)

    def look_down(self, bounds):
        """From above, north up, without perspective, with a scale bar. Returns metres per pixel."""
        x0, x1, y0, y1 = bounds[:4]
        columns = self.width - self.left - self.right
        rows = self.height - self.above - self.below
        metres = max((x1 - x0) / columns, (y1 - y0) / rows, 1e-6)
        camera = self.view.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(0.5 * rows * metres)
        camera.SetFocalPoint(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0)
        camera.SetPosition(0.5 * (x0 + x1), 0.5 * (y0 + y1), 5000)
        camera.SetViewUp(0, 1, 0)
        camera.SetClippingRange(1, 10000)
        self._scale_bar(metres)
        return metres

    def _scale_bar(self, metres):
        length = nice(0.25 * self.width * metres)
        x, y, pixels = self.left + 10, self.below - 38, length / metres
        self.line([(x, y + 8), (x, y), (x + pixels, y), (x + pixels, y + 8)], width=3)
        words = f"{length / 1000:g} km" if length >= 1000 else f"{length:g} m"
        self.text(x + pixels + 14, y + 3, words, 22)
        x = x + pixels + 190
        self.line([(x, y - 10), (x, y + 24)], width=3)
        self.line([(x - 7, y + 12), (x, y + 26), (x + 7, y + 12)], width=3)
        self.text(x + 14, y + 3, "N", 22)

    def label(self, point, words, across):
        """Words beside a place of the scene; it is at their end that `across` names."""
        actor = vtkTextActor()
        actor.SetInput(words)
        actor.GetPositionCoordinate().SetCoordinateSystemToWorld()
        actor.SetPosition(*point[:2])
        style = actor.GetTextProperty()
        style.SetFontFamilyToArial()
        style.SetFontSize(20)
        style.SetColor(*GREY)
        (style.SetJustificationToLeft if across == "left" else style.SetJustificationToRight)()
        style.SetVerticalJustificationToCentered()
        self.view.AddActor2D(actor)

    def note(self, words):
        """Lower right."""
        self.text(self.width - 25, self.below - 35, words, 18, across="right", color=GREY)

    def look(self, position, focal_point, angle=60):
        """With perspective, up is up; the angle is the view's height in degrees."""
        camera = self.view.GetActiveCamera()
        camera.SetPosition(*position)
        camera.SetFocalPoint(*focal_point)
        camera.SetViewUp(0, 0, 1)
        camera.SetViewAngle(angle)
        self.view.ResetCameraClippingRange()


def range_picture(image, title, energy_limits):
    """The range image of `Scan.range_image` as two strips, azimuth by elevation: range in grey, energy as hue. Returns a
    Page."""
    rows, columns = image["distance_m"].shape
    across = max(1, 1920 // columns)
    up = max(1, 260 // rows)
    width, height = columns * across, rows * up
    page = Page(width + 300, 2 * height + 290)
    left, lower = 110, 100
    page.text(left, page.height - 38, title, 30, bold=True)
    azimuths, elevations, distance, energy = (
        image[name] for name in ("column_azimuths", "row_elevations", "distance_m", "energy"))
    seen = distance[np.isfinite(distance)]
    near, far = (seen.min(), seen.max()) if len(seen) else (0, 1)
    metres = "{:.0f}" if far > 50 else "{:.1f}"
    strips = ((lower + height + 80, grey_colors, distance, near, far, "range (m)", 1, metres),
              (lower, hue_colors, energy, *energy_limits, "energy (\u00b5J)", 1e-6, "{:.1f}"))
    for y, colors, values, low, high, name, unit, labels in strips:
        page.pixels(left, y, colors(values, low, high).repeat(up, axis=0).repeat(across, axis=1))
        page.line([(left, y), (left + width, y), (left + width, y + height), (left, y + height), (left, y)], width=1)
        page.hue_bar(low, high, left + width + 40, y, height - 30, colors, name, unit, labels)
        _axes(page, left, y, width, height, azimuths, elevations)
    page.text(left + width / 2, 28, "azimuth from north, clockwise (deg)", 22, "centre")
    return page


def _axes(page, x, y, width, height, azimuths, elevations):
    """Ticks every 30 degrees of azimuth and at whole steps of elevation, where these lie between the rows."""
    step = azimuths[1] - azimuths[0] if len(azimuths) > 1 else 1
    for azimuth in np.arange(math.ceil(azimuths[0] / 30) * 30, azimuths[-1] + step, 30):
        at = x + ((azimuth - azimuths[0]) / step + 0.5) * width / len(azimuths)
        if at <= x + width:
            page.line([(at, y), (at, y - 8)])
            page.text(at, y - 22, f"{azimuth:g}", 20, "centre")
    for elevation in even_ticks(elevations[0], elevations[-1]):
        at = y + (np.interp(elevation, elevations, np.arange(len(elevations))) + 0.5) * height / len(elevations)
        page.line([(x - 8, at), (x, at)])
        page.text(x - 14, at, f"{elevation:.4g}", 20, "right")
    page.text(x - 85, y + height / 2, "elevation (deg)", 20, "centre", turn=90)
