# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours the selected labelled points (semantic_label) by class, with the classes' names.

The first Apply of an Avian Lidar Sequence Reader also runs the macro. Colours and names are as in the file
semantic-kitti.yaml of the sequences. Boxes of moving objects are drawn as lines.

In ParaView: select the points, and choose the macro in the menu Macros. In a script: colour(source, view).
"""

from avian_lidar_plugin import run, show
from paraview import simple

ARRAY = "semantic_label"
READER = "AvianLidarSequenceReader"
# Name and colour (red, green, blue) of each class, as in avianlidar's sequences.
CLASSES = {
    0: ("unlabeled", (0, 0, 0)),
    1: ("outlier", (200, 215, 235)),
    10: ("car", (175, 200, 230)),
    18: ("truck", (160, 218, 230)),
    20: ("other-vehicle", (150, 225, 140)),
    40: ("road", (90, 90, 90)),
    44: ("parking", (120, 110, 125)),
    49: ("other-ground", (60, 130, 190)),
    50: ("building", (140, 140, 140)),
    51: ("fence", (140, 100, 75)),
    52: ("other-structure", (185, 160, 125)),
    70: ("vegetation", (35, 125, 60)),
    72: ("terrain", (125, 165, 110)),
    80: ("pole", (30, 30, 30)),
    81: ("traffic-sign", (200, 40, 40)),
    99: ("bird", (215, 0, 110)),
    252: ("moving-car", (30, 120, 180)),
    258: ("moving-truck", (25, 190, 205)),
    259: ("moving-other-vehicle", (45, 160, 45)),
}
POINT_SIZE = 4  # size of a point, pixels
FONT_SIZE, LEGEND = 10, 0.6  # font size and length of the legend (points, share of the view's height)
BOX_COLOUR = (1.0, 1.0, 1.0)


def colour(source, view=None):
    """Colours the points of the source by class, and shows the boxes of a sequence. @return the display"""
    if source is None or not source.GetPointDataInformation().GetArray(ARRAY):
        raise ValueError(f"select labelled points first (point array {ARRAY}), such as an opened sequence")
    view = view or simple.GetActiveViewOrCreate("RenderView")
    display = show(source, view, Representation="Points", PointSize=POINT_SIZE)
    simple.ColorBy(display, ("POINTS", ARRAY))
    table = simple.GetColorTransferFunction(ARRAY)
    table.InterpretValuesAsCategories = 1
    table.AnnotationsInitialized = 1
    table.Annotations = [text for label, (name, _) in CLASSES.items() for text in (str(label), name)]
    table.IndexedColors = [value / 255 for _, colour_of in CLASSES.values() for value in colour_of]
    table.IndexedOpacities = [1.0] * len(CLASSES)
    bar = simple.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = "class", ""
    bar.LabelFontSize, bar.ScalarBarLength, bar.WindowLocation = FONT_SIZE, LEGEND, "Upper Left Corner"
    display.SetScalarBarVisibility(view, True)
    if source.SMProxy.GetXMLName() == READER:
        show(simple.OutputPort(source, 1), view, BOX_COLOUR, Representation="Wireframe")
    return display


if __name__ in ("__main__", "__vtkconsole__"):
    run("class colours", colour, simple.GetActiveSource())
