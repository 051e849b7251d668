# SPDX-License-Identifier: BSD-3-Clause
"""Makes a source proxy of each sensor that is built in: make_sensors.py sensors... sources.xml contents.xml

Each is the proxy of the beam source (Filters/AvianLidarBeamSource.xml) with the values of a sensor file as defaults, in a category
of Sources for its maker. What a file has and no property (TablesOfPreset) comes by the sensor's name. contents.xml are the lines
of the help's table of contents. Run by CMake."""

import copy
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

BASE = pathlib.Path(__file__).resolve().parent / "Filters" / "AvianLidarBeamSource.xml"
CATEGORY = "Avian Lidar"


def camel(name):
    return "".join(word.capitalize() for word in name.split("_"))


def words(name):
    """CorridorC16 -> Corridor C16, Airport16 -> Airport 16."""
    return re.sub(r"(?<=[a-z])(?=[A-Z\d])", " ", name)


def text_of(value):
    return " ".join(repr(one) for one in (value if isinstance(value, list) else [value]))


def element(parent, tag, **attributes):
    return ElementTree.SubElement(parent, tag, attributes)


def overridden(base, name, value):
    """The property with another default."""
    found = copy.deepcopy(base[name])
    count = len(value) if isinstance(value, list) else 1
    found.attrib.update(default_values=text_of(value), number_of_elements=str(count), override="1")
    if found.tag == "StringVectorProperty":
        found.set("default_values", value)
    return found


def proxy_of(sensor, base):
    name, model = sensor["name"], sensor.get("model", words(sensor["name"]))
    maker = sensor.get("maker")
    full = model if maker in (None, "assumed") else f"{maker} {model}"
    comment = sensor["comment"]
    # Without "_", at which ParaView's help splits names.
    proxy = ElementTree.Element("SourceProxy", {
        "name": "AvianLidar" + name.replace("_", ""), "class": "vtkAvianLidarBeamSource",
        "label": f"{CATEGORY} {name.replace('_', ' ') if maker not in (None, 'assumed') else model}",
        "base_proxygroup": "sources", "base_proxyname": "AvianLidarBeamSource"})
    documentation = element(proxy, "Documentation", short_help=f"The sensor {full}.", long_help=comment + ".")
    documentation.text = (f"The beam source with the values of this sensor: {comment}. Each number's source is in the sensor file {name}; "
                          "the field data assumed names what nobody has measured. Values can be changed here as of any beam source.")
    values = {camel(key): number["value"] for key, number in sensor["values"].items()}
    if "HalfBeamwidth" in values:
        values["BeamwidthMilliradians"] = round(2000 * values["HalfBeamwidth"], 9)
    for key, value in values.items():
        if key in base:
            proxy.append(overridden(base, key, value))
    proxy.append(overridden(base, "TablesOfPreset", name))
    hints = element(proxy, "Hints")
    category = f"{CATEGORY}: {maker[0].upper() + maker[1:]}" if maker else CATEGORY
    element(hints, "ShowInMenu", category=category, icon=":/AvianLidar/Icons/sensor.svg")
    if full != model:
        element(hints, "AvianLidarMenu", text=full, pipeline="1")  # what the menu and the pipeline call it
    element(hints, "View", type="None", port="1")
    element(hints, "RepresentationType", view="RenderView", port="0", type="Points")
    return full, proxy


def write(path, text):
    """Not anew what is there: all that is built of it would be, too."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def main(*files):
    *sensors, sources, contents = map(pathlib.Path, files)
    base = ElementTree.parse(BASE).getroot().find("ProxyGroup/SourceProxy")
    base = {prop.get("name"): prop for prop in base if prop.tag.endswith("Property")}
    root = ElementTree.Element("ServerManagerConfiguration")
    group = element(root, "ProxyGroup", name="sources")
    made = [proxy_of(json.loads(file.read_text(encoding="utf-8")), base) for file in sensors]
    group.extend(proxy for _, proxy in made)
    ElementTree.indent(root)
    write(sources, "<!-- Made by make_sensors.py of Filters/Sensors. -->\n" + ElementTree.tostring(root, encoding="unicode") + "\n")
    lines = [f'<section title="{full}" ref="sources.{proxy.get("name")}.html" />\n' for full, proxy in sorted(made, key=lambda one: one[0])]
    write(contents, "".join(lines))


if __name__ == "__main__":
    main(*sys.argv[1:])
