# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours the selected labelled points (semantic_label) by class, with the classes' names.

The first Apply of an Avian Lidar Sequence Reader also runs the macro. Colours and names are as in the file
semantic-kitti.yaml of the sequences. Boxes of moving objects are drawn as lines.

In ParaView: select the points, and choose the macro in the menu Macros. In a script: colour(source, view).
"""

from paraview import simple  # first: lets Python find avian_lidar_plugin
from avian_lidar_plugin import data, legend, light, run, show

ARRAY = "semantic_label"
READER = "AvianLidarSequenceReader"
POINT_SIZE = 4  # size of a point, pixels
FONT_SIZE, LEGEND = 10, 0.6  # font size and length of the legend (points, share of the view's height)
BOX_COLOUR = (0.0, 0.0, 0.0)


def colour(source, view=None):
    """Colours the points of the source by class, and shows the boxes of a sequence. @return the display"""
    if source is None or not source.GetPointDataInformation().GetArray(ARRAY):
        raise ValueError(f"select labelled points first (point array {ARRAY}), such as an opened sequence")
    view = view or simple.GetActiveViewOrCreate("RenderView")
    light(view)
    display = show(source, view, Representation="Points", PointSize=POINT_SIZE)
    simple.ColorBy(display, ("POINTS", ARRAY))
    table = simple.GetColorTransferFunction(ARRAY)
    table.InterpretValuesAsCategories = 1
    table.AnnotationsInitialized = 1
    classes = sorted((int(label), name, bgr) for label, (name, _, bgr) in data("classes.json").items())
    table.Annotations = [text for label, name, _ in classes for text in (str(label), name)]
    table.IndexedColors = [value / 255 for _, _, bgr in classes for value in reversed(bgr)]
    table.IndexedOpacities = [1.0] * len(classes)
    bar = legend(table, view, "class")
    bar.LabelFontSize, bar.ScalarBarLength, bar.WindowLocation = FONT_SIZE, LEGEND, "Upper Left Corner"
    display.SetScalarBarVisibility(view, True)
    if source.SMProxy.GetXMLName() == READER:
        show(simple.OutputPort(source, 1), view, BOX_COLOUR, Representation="Wireframe")
    return display


if __name__ in ("__main__", "__vtkconsole__"):
    run("class colours", colour, simple.GetActiveSource())
