# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the corridor: what the lidar sees of the door, the stairwell and the corridor, as in paper, Fig. 13-15.
Colour is energy, the diameter of a dot tells its distance: near is large."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkTriangleFilter

import pictures
import views

# Pale colours of the materials of Table 1.
FACES = {0: (0.95, 0.95, 0.94), 1: (0.78, 0.87, 0.93), 2: (0.72, 0.72, 0.75), 3: (0.90, 0.82, 0.70)}

# Name, title, looking at (from the lidar), height of the view in degrees.
AREAS = (("door", "The door, its window and the hydrant cabinet", (-3.5, 0, 1.3), 42),
         ("stairwell", "The stairwell with its handrail", (0.75, -4.2, 1.35), 50),
         ("corridor", "The corridor and its bulletin board", (24, 0.6, 1.3), 66))


def seen_from(eye, echoes, pull=0.9):
    """A copy with the diameters of the dots: as the square root of the distance, so that what is nearer looks larger.
    Dots are pulled a little towards the eye, which they seem not to leave, so that surfaces do not cut them."""
    copy, places = vtkPolyData(), vtkPoints()
    copy.ShallowCopy(echoes)
    places.SetData(numpy_to_vtk(np.add(eye, pull * (vtk_to_numpy(echoes.GetPoints().GetData()) - eye)), deep=True))
    copy.SetPoints(places)
    distance = vtk_to_numpy(echoes.GetPointData().GetArray("distance_m"))
    diameter = numpy_to_vtk(0.028 * pull * np.sqrt(distance), deep=True)
    diameter.SetName("diameter")
    copy.GetPointData().AddArray(diameter)
    return copy


def triangulated(surfaces):
    triangles = vtkTriangleFilter()
    triangles.SetInputData(surfaces)
    triangles.Update()
    return triangles.GetOutput()


def area_view(scene, echoes, title, words, target, angle):
    eye = views.lidar_position(echoes)
    picture = pictures.Picture(title, "", 1300, 900)
    for i in range(scene.GetNumberOfBlocks()):
        surfaces = triangulated(scene.GetBlock(i))
        material = int(vtk_to_numpy(surfaces.GetCellData().GetArray("material_id"))[0])
        picture.faces(surfaces, FACES.get(material, FACES[0]))
        picture.outlines(pictures.edges(surfaces, 40), (0.3, 0.3, 0.3))
    if echoes.GetNumberOfPoints():
        picture.dots(seen_from(eye, echoes), "diameter")
    picture.look(eye, target, angle)
    picture.subtitle(f"{words}, {views.count_in_words(picture, echoes)}")
    picture.hue_bar(*views.limits(echoes))
    picture.note("seen from the lidar; the larger a dot, the nearer")
    return picture


def draw(scene, echoes, image, built, options):
    """Write door.png, stairwell.png, corridor.png (of the built scene), top.png and range.png."""
    words = f"C16, {options.rays} rays per beam"
    for name, title, target, angle in AREAS if built else ():
        area_view(scene, echoes, title, words, target, angle).save(options.out / f"{name}.png")
    shapes = [("", pictures.edges(triangulated(scene.GetBlock(i)), 40)) for i in range(scene.GetNumberOfBlocks())]
    bounds = views.around(views.site(scene, echoes), 0.05)
    views.from_above(shapes, echoes, "Echoes from above", words, bounds, 6).save(options.out / "top.png")
    title = f"Range image: {words}, {echoes.GetNumberOfPoints()} echoes"
    page = pictures.range_picture(image, title, views.limits(echoes))
    page.save(options.out / "range.png")
